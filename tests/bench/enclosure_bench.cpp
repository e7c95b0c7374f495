// How much wider enclosures are than what they enclose, and what they cost: the mean ratio over
// boxes of side 0.5 / s (0.5 / a; 0.2 R for kernels of finite support) near the surface, for one
// primitive and for sums of twenty: with Taylor polynomials of first and of second order, as
// enclose() gives it, and in batches of 64 that tell signs.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "libfield/field/term_bounds.h"

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

std::vector<Term> random_terms(KernelKind kind, std::size_t shape, std::size_t count,
                               Random& random) {
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
  return terms;
}

/// Points of the skeleton, where kernels peak.
void append_skeleton(const Term& term, std::vector<Vec3d>& points) {
  if (const auto* point = std::get_if<Point>(&term.primitive)) points.push_back(point->position);
  if (const auto* segment = std::get_if<Segment>(&term.primitive)) {
    for (int i = 0; i <= 64; ++i)
      points.push_back(segment->a + i / 64.0 * (segment->b - segment->a));
  }
}

/// The range over a lattice of 7^3 points, corners included, and over what of the skeleton lies in
/// the box.
double sampled_range(const Field& field, const std::vector<Term>& terms, const Aabb& box) {
  std::vector<Vec3d> points;
  for (const Term& term : terms) append_skeleton(term, points);
  std::erase_if(points, [&](const Vec3d& p) { return !box.contains(p); });
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

Interval enclose_to_order(const std::vector<Term>& terms, const Aabb& box, TaylorOrder order) {
  const BatchBox one(box);
  const BoxBatch batch({&one, 1}, order);
  SumBound sum;
  const double negligible = 0.01 / static_cast<double>(terms.size());
  for (const Term& term : terms) add_bounds(term, batch, negligible, {&sum, 1});
  return range_of(sum, terms.size(), one);
}

/// The box and 63 neighbours.
std::vector<Aabb> lattice_of(const Aabb& box) {
  const double side = box.extent().x;
  std::vector<Aabb> parts;
  for (int k = 0; k < 64; ++k) {
    const Vec3d shift{side * (k % 4 - 1.5), side * (k / 4 % 4 - 1.5), side * (k / 16 - 1.5)};
    parts.push_back({box.min + shift, box.max + shift});
  }
  parts[0] = box;
  return parts;
}

/// Processor time of this program.
double nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

/// Sums over boxes.
struct Figures {
  double first = 0.0, second = 0.0, alone = 0.0, batched = 0.0;  ///< widths over ranges
  double alone_ns = 0.0, batched_ns = 0.0;
  int boxes = 0;

  void add(const Field& field, const std::vector<Term>& terms, const Aabb& box, double range) {
    ++boxes;
    first += enclose_to_order(terms, box, TaylorOrder::first).width() / range;
    second += enclose_to_order(terms, box, TaylorOrder::second).width() / range;
    double start = nanoseconds();
    alone += field.enclose(box).width() / range;
    alone_ns += nanoseconds() - start;
    const std::vector<Aabb> parts = lattice_of(box);
    std::vector<Interval> out(parts.size());
    start = nanoseconds();
    field.enclose_each(parts, out);
    batched_ns += (nanoseconds() - start) / static_cast<double>(parts.size());
    batched += out[0].width() / range;
  }
  void print() const {
    std::printf("  %6.2f %6.2f %6.2f %6.2f %7.0f %6.0f", first / boxes, second / boxes,
                alone / boxes, batched / boxes, alone_ns / boxes, batched_ns / boxes);
  }
};

void report(KernelKind kind, std::size_t shape) {
  const bool infinite = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  const double side = infinite ? 0.5 / 4.0 : 0.2 * 0.6;
  std::printf("%-9s %-9s", std::string(name_of(kind)).c_str(), std::string(kShapes[shape]).c_str());
  for (const std::size_t count : {1, 20}) {
    Figures figures;
    for (int i = 0; i < 4000 && figures.boxes < 200; ++i) {
      Random random(7, static_cast<std::uint64_t>(i));
      const std::vector<Term> terms = random_terms(kind, shape, count, random);
      const Field field(terms, 1e-9);
      const Vec3d center = random.uniform(0.0, 2.0) * random.direction();
      const Vec3d half{0.5 * side, 0.5 * side, 0.5 * side};
      const Aabb box{center - half, center + half};
      const double f = field.value(center);
      if (!(std::abs(f) < 0.7)) continue;  // near the surface
      const double range = sampled_range(field, terms, box);
      if (range > 1e-9) figures.add(field, terms, box, range);
    }
    figures.print();
  }
  std::printf("\n");
}

}  // namespace
}  // namespace cs2mesh

int main() {
  std::printf(
      "Width / range at both orders, of enclose() and enclose_each(); ns a box of these.\n");
  std::printf("%-20s %-44s sum of twenty\n%-19s", "", "one primitive", "");
  for (int i = 0; i < 2; ++i) std::printf("   first second  alone  batch   alone  batch");
  std::printf("\n");
  for (const cs2mesh::KernelKind kind : cs2mesh::kAllKernels) {
    for (std::size_t shape = 0; shape < 4; ++shape) {
      const bool slow = shape >= 2 && kind != cs2mesh::KernelKind::cauchy;  // quadrature
      if (!slow) cs2mesh::report(kind, shape);
    }
  }
}
