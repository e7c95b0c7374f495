// How much wider enclosures are than what they enclose: the mean ratio over boxes of side 0.5 / s
// (0.5 / a; 0.2 R for kernels of finite support) near the surface, for one primitive and for sums
// of twenty, singly and in batches of 64.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/field.h"

namespace cs2mesh {
namespace {

constexpr std::string_view kShapes[] = {"point", "segment", "arc", "triangle"};

Primitive random_shape(std::size_t shape, const Vec3d& origin, double size, Random& random) {
  const Vec3d a = random.direction();
  const Vec3d b = normalized(cross(a, random.direction()));
  switch (shape) {
    case 0:
      return Point{origin};
    case 1:
      return Segment{origin, origin + size * a};
    case 2:
      return make_arc(origin, 0.5 * size, a, 0, 120);
    default:
      return Triangle{{origin, origin + size * a, origin + 0.8 * size * b}};
  }
}

Field random_field(KernelKind kind, std::size_t shape, std::size_t count, Random& random) {
  const bool infinite = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  std::vector<Term> terms;
  for (std::size_t i = 0; i < count; ++i) {
    Term term;
    const Vec3d origin = count == 1 ? Vec3d{} : random.uniform(0.0, 1.5) * random.direction();
    term.primitive = random_shape(shape, origin, 1.0, random);
    term.frame = frame_of(term.primitive);
    const bool inverse = kind == KernelKind::inverse || kind == KernelKind::squared;
    const double strength = inverse ? 0.6 / static_cast<double>(count) : 8.0;
    term.kernel = make_kernel(kind, infinite ? 4.0 : 0.6, strength, std::log(strength), 1e-6);
    terms.push_back(term);
  }
  return Field(std::move(terms), 1e-9);
}

/// The range over a lattice of 7^3 points, corners included.
double sampled_range(const Field& field, const Aabb& box) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 343; ++i) {
    const Vec3d at{static_cast<double>(i % 7) / 6, static_cast<double>(i / 7 % 7) / 6,
                   static_cast<double>(i / 49) / 6};
    const Vec3d extent = box.extent();
    points.push_back(box.min + Vec3d{at.x * extent.x, at.y * extent.y, at.z * extent.z});
  }
  std::vector<double> values(points.size());
  field.values(points, values);
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

void report(KernelKind kind, std::size_t shape) {
  const bool infinite = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  const double side = infinite ? 0.5 / 4.0 : 0.2 * 0.6;
  std::printf("%-9s %-9s", std::string(name_of(kind)).c_str(), std::string(kShapes[shape]).c_str());
  for (const std::size_t count : {1, 20}) {
    double single = 0.0, batched = 0.0;
    int boxes = 0;
    for (int i = 0; i < 4000 && boxes < 200; ++i) {
      Random random(7, static_cast<std::uint64_t>(i));
      const Field field = random_field(kind, shape, count, random);
      const Vec3d center = random.uniform(0.0, 2.0) * random.direction();
      const Vec3d half{0.5 * side, 0.5 * side, 0.5 * side};
      const Aabb box{center - half, center + half};
      const double f = field.value(center);
      if (!(std::abs(f) < 0.7)) continue;  // near the surface
      const double range = sampled_range(field, box);
      if (!(range > 1e-9)) continue;
      ++boxes;
      single += field.enclose(box).width() / range;
      std::vector<Aabb> parts;
      std::vector<Interval> out(64);
      for (int k = 0; k < 64; ++k) {
        const Vec3d shift{side * (k % 4 - 1.5), side * (k / 4 % 4 - 1.5), side * (k / 16 - 1.5)};
        parts.push_back({box.min + shift, box.max + shift});
      }
      parts[0] = box;
      field.enclose_each(parts, out);
      batched += out[0].width() / range;
    }
    std::printf("   %6.2f %6.2f", single / boxes, batched / boxes);
  }
  std::printf("\n");
}

}  // namespace
}  // namespace cs2mesh

int main() {
  std::printf("enclosure width / range   one primitive      sum of twenty\n");
  std::printf("                          alone  batch       alone  batch\n");
  for (const cs2mesh::KernelKind kind : cs2mesh::kAllKernels) {
    for (std::size_t shape = 0; shape < 4; ++shape) {
      const bool slow = shape >= 2 && kind != cs2mesh::KernelKind::cauchy;  // quadrature
      if (!slow) cs2mesh::report(kind, shape);
    }
  }
}
