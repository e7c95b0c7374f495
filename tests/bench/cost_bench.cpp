// What a near primitive costs at a point, in nanoseconds of one core, for every pair with a closed
// form: one point at a time in plain code, and in blocks of 512 points with each instruction set;
// the value alone and with its gradient. Beside it the ratios to a point: here, and in table 2.6 of
// the thesis (Cauchy, values). Then what second derivatives cost, for every pair.

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/term.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/integral.h"

namespace cs2mesh {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::array<std::string_view, 6> kShapes = {"point",    "segment", "arc",
                                                     "triangle", "plane",   "tapered"};
constexpr std::array<double, 5> kThesis = {1.0, 4.48, 8.17, 14.36, 1.02};

/// The least processor time of some repetitions, in nanoseconds a call.
double least_time(const std::function<void()>& work) {
  double least = 1e300;
  for (int repetition = 0; repetition < 7; ++repetition) {
    constexpr int kCalls = 20;
    const std::clock_t start = std::clock();
    for (int i = 0; i < kCalls; ++i) work();
    const auto spent = static_cast<double>(std::clock() - start);
    least = std::min(least, 1e9 * spent / CLOCKS_PER_SEC / kCalls);
  }
  return least;
}

Primitive near_origin(std::size_t shape) {
  switch (shape) {
    case 0:
      return Point{{0.1, 0, 0}};
    case 1:
      return Segment{{-0.5, 0, 0}, {0.5, 0, 0}};
    case 2:
      return make_arc({0, -1, 0}, 1, {0, 0, 1}, 60, 60);
    case 3:
      return Triangle{{Vec3d{-0.5, -0.3, 0}, {0.5, -0.3, 0}, {0, 0.5, 0}}};
    case 4:
      return Plane{};
    default:
      return TaperedSegment{{{-0.5, 0, 0}, {0.5, 0, 0}}, quadratic_weight(1, 0.5, 0.25)};
  }
}

/// The nodes of a lattice around the primitive.
std::vector<Vec3d> lattice() {
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < kBlock; ++i) {
    points.push_back(0.2 * Vec3d{static_cast<double>(i % 8) - 3.4,
                                 static_cast<double>(i / 8 % 8) - 3.3,
                                 static_cast<double>(i / 64) - 3.6});
  }
  return points;
}

/// Points are summed many at a time, as fields do.
template <class Out>
double block_cost(const Term& term, const std::vector<Vec3d>& points) {
  std::vector<Out> sums(points.size());
  if (const auto* point = std::get_if<Point>(&term.primitive)) {
    constexpr std::size_t kSources = 64;
    std::vector<PointSource> sources(kSources, point_source(term.kernel, *point, 1.0));
    std::vector<std::uint32_t> index(kSources);
    Random random(3);
    for (std::uint32_t i = 0; i < kSources; ++i) {
      index[i] = i;
      sources[i].position = 0.5 * random.direction();
    }
    const auto add = bulk_table().point_row<Out>()[term.kernel.index()];
    return least_time([&] {
             add(sources.data(), index.data(), kSources, points.data(), sums.data(), points.size());
           }) /
           static_cast<double>(kSources * points.size());
  }
  return least_time([&] { accumulate(term, points, std::span(sums)); }) /
         static_cast<double>(points.size());
}

/// One point after the other, by the formulas over doubles.
double scalar_cost(const Term& term, const std::vector<Vec3d>& points) {
  volatile double keep = 0.0;
  return std::visit(
             [&](const auto& kernel, const auto& primitive) {
               if constexpr (!kHasField<std::decay_t<decltype(kernel)>,
                                        std::decay_t<decltype(primitive)>>) {
                 return 0.0;
               } else {
                 return least_time([&] {
                   double sum = 0.0;
                   for (const Vec3d& p : points) {
                     const Jet jet = integral(kernel, primitive, p);
                     sum += jet.value + jet.gradient.x + jet.gradient.y + jet.gradient.z;
                   }
                   keep = sum;
                 });
               }
             },
             term.kernel, term.primitive) /
         static_cast<double>(points.size());
}

bool has_field(KernelKind kind, std::size_t shape) {
  const bool inverse = kind == KernelKind::inverse || kind == KernelKind::squared;
  if (shape == 4) return !inverse;
  return shape != 5 || kind == KernelKind::cauchy || kind == KernelKind::gaussian;
}

void print_row(KernelKind kind, std::size_t shape, const std::vector<Vec3d>& points,
               double& point_cost) {
  Term term;
  term.kernel = make_kernel(kind, kind == KernelKind::cauchy ? 3.0 : 1.5, 1.0, 0.0, 1e-6);
  term.primitive = near_origin(shape);
  term.frame = frame_of(term.primitive);
  std::printf("%-9s %-9s %8.2f", std::string(name_of(kind)).c_str(),
              std::string(kShapes[shape]).c_str(), scalar_cost(term, points));
  double value = 0.0;
  for (const Isa isa : available_isas()) {
    use_isa(isa);
    value = block_cost<double>(term, points);
    std::printf("  %8.2f %8.2f", value, block_cost<Jet>(term, points));
  }
  if (shape == 0) point_cost = value;
  std::printf("  %7.2f", value / point_cost);
  if (kind == KernelKind::cauchy && shape < kThesis.size()) {
    std::printf("  %7.2f", kThesis[shape]);
  }
  std::printf("\n");
}

void print_table() {
  const std::vector<Vec3d> points = lattice();
  std::printf("ns a point and primitive    scalar");
  for (const Isa isa : available_isas()) {
    std::printf("  %8s: v      jet", std::string(name_of(isa)).c_str());
  }
  std::printf("   to a point  thesis\n");
  for (const KernelKind kind : kAllKernels) {
    double point_cost = 1.0;
    for (std::size_t shape = 0; shape < kShapes.size(); ++shape) {
      if (has_field(kind, shape)) print_row(kind, shape, points, point_cost);
    }
  }
}

void print_second_derivatives() {
  std::vector<Vec3d> points;
  for (const Vec3d& p : lattice()) {
    if (norm(p) < 0.6 && points.size() < 16) points.push_back(p);  // some take a millisecond
  }
  std::printf("\nns a second derivative");
  for (const std::string_view shape : kShapes) std::printf("  %9s", std::string(shape).c_str());
  for (const KernelKind kind : kAllKernels) {
    std::printf("\n%-22s", std::string(name_of(kind)).c_str());
    for (std::size_t shape = 0; shape < kShapes.size(); ++shape) {
      if (!has_field(kind, shape)) {
        std::printf("  %9s", "-");
        continue;
      }
      Term term;
      term.kernel = make_kernel(kind, kind == KernelKind::cauchy ? 3.0 : 1.5, 1.0, 0.0, 1e-6);
      term.primitive = near_origin(shape);
      term.frame = frame_of(term.primitive);
      std::vector<Symmetric3> sums(points.size());
      const double spent = least_time([&] { accumulate(term, points, std::span(sums)); });
      std::printf("  %9.0f", spent / static_cast<double>(points.size()));
    }
  }
  std::printf("\n");
}

}  // namespace
}  // namespace cs2mesh

int main() {
  cs2mesh::print_table();
  cs2mesh::print_second_derivatives();
}
