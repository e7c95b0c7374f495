// Cost of one evaluation (value and gradient) of each kernel on each primitive, for a single point
// and for the points of a lattice block, with every instruction set. Times of different cells are
// comparable within one run.
#include <benchmark/benchmark.h>

#include <cmath>

#include "libfield/base/random.h"
#include "libfield/field/term.h"
#include "libfield/integral/bulk.h"
#include "libfield/simd/isa.h"

namespace cs2mesh {
namespace {

Primitive unit_primitive(std::size_t which) {
  switch (which) {
    case 0:
      return Point{{0, 0, 0}};
    case 1:
      return Segment{{-0.5, 0, 0}, {0.5, 0, 0}};
    case 2:
      return make_arc({0, -1, 0}, 1, {0, 0, 1}, 60, 60);
    case 3:
      return Triangle{{Vec3d{-0.5, 0, 0}, {0.5, 0, 0}, {0, 0.8, 0}}};
    default:
      return Plane{};
  }
}

constexpr std::size_t kBlock = 512;

/// Points as a mesher asks for them: the nodes of small lattices, here and there about the origin.
std::vector<Vec3d> lattice_blocks(std::size_t blocks) {
  std::vector<Vec3d> points;
  Random random(1);
  for (std::size_t b = 0; b < blocks; ++b) {
    const Vec3d corner{random.uniform(-1, 0.8), random.uniform(-1, 0.8), random.uniform(-1, 0.8)};
    for (std::size_t i = 0; i < kBlock; ++i) {
      const Vec3d step{static_cast<double>(i % 8), static_cast<double>(i / 8 % 8),
                       static_cast<double>(i / 64)};
      points.push_back(corner + 0.025 * step);
    }
  }
  return points;
}

/// Arguments: kernel, primitive, points a call, instructions.
void evaluate_term(benchmark::State& state) {
  const auto kind = kAllKernels[static_cast<std::size_t>(state.range(0))];
  const auto batch = static_cast<std::size_t>(state.range(2));
  const Isa isa = static_cast<Isa>(state.range(3));
  use_isa(isa);
  Term term;
  term.kernel = make_kernel(kind, 3.0, 1.0, 0.0, 0.0);
  term.primitive = unit_primitive(static_cast<std::size_t>(state.range(1)));
  term.frame = frame_of(term.primitive);
  const std::vector<Vec3d> points = lattice_blocks(32);
  std::vector<Jet> sums(batch);
  std::size_t first = 0;
  for (auto _ : state) {
    accumulate(term, {points.data() + first, batch}, sums);
    benchmark::DoNotOptimize(sums.data());
    first = (first + batch) % points.size();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(batch));
  constexpr const char* kPrimitives[] = {"point", "segment", "arc", "triangle", "plane"};
  state.SetLabel(std::string(name_of(kind)) + " x " + kPrimitives[state.range(1)] + ", " +
                 std::string(name_of(isa)));
}

/// Many points of one kernel at the points of a lattice block; items are pairs of the two.
template <class Out>
void sum_points(benchmark::State& state) {
  const auto kind = kAllKernels[static_cast<std::size_t>(state.range(0))];
  const Isa isa = static_cast<Isa>(state.range(1));
  use_isa(isa);
  constexpr std::size_t kSources = 256;
  Random random(2);
  std::vector<PointSource> sources;
  std::vector<std::uint32_t> index(kSources);
  for (std::uint32_t i = 0; i < kSources; ++i) {
    const Point point{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    sources.push_back(point_source(make_kernel(kind, 1.5, 1.0, 0.0, 1e-6), point, 1.0));
    index[i] = i;
  }
  const std::vector<Vec3d> points = lattice_blocks(1);
  std::vector<Out> sums(points.size());
  const auto add = bulk_table().point_row<Out>()[static_cast<std::size_t>(kind)];
  for (auto _ : state) {
    add(sources.data(), index.data(), kSources, points.data(), sums.data(), points.size());
    benchmark::DoNotOptimize(sums.data());
  }
  const double pairs = static_cast<double>(kSources * points.size());
  state.counters["ns_a_pair"] = benchmark::Counter(
      1e-9 * pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetLabel(std::string(name_of(kind)) + ", " + std::string(name_of(isa)));
}

/// What the compiler makes of a plain loop with the C library's exp.
void sum_gaussians_with_libm(benchmark::State& state) {
  constexpr std::size_t kSources = 256;
  Random random(2);
  std::vector<Vec3d> sources;
  for (std::size_t i = 0; i < kSources; ++i) {
    sources.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  }
  const std::vector<Vec3d> points = lattice_blocks(1);
  std::vector<double> sums(points.size());
  for (auto _ : state) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      double sum = 0.0;
      for (const Vec3d& source : sources) {
        sum += std::exp(-2.25 * squared_norm(points[i] - source));
      }
      sums[i] += sum;
    }
    benchmark::DoNotOptimize(sums.data());
  }
  const double pairs = static_cast<double>(kSources * points.size());
  state.counters["ns_a_pair"] = benchmark::Counter(
      1e-9 * pairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void register_point_sums() {
  for (std::int64_t kernel = 0; kernel < 7; ++kernel) {
    for (const Isa isa : available_isas()) {
      const auto number = static_cast<std::int64_t>(isa);
      benchmark::RegisterBenchmark("points_values", sum_points<double>)->Args({kernel, number});
      benchmark::RegisterBenchmark("points_jets", sum_points<Jet>)->Args({kernel, number});
    }
  }
  benchmark::RegisterBenchmark("gaussian_points_libm", sum_gaussians_with_libm);
}

void register_cells() {
  for (std::int64_t kernel = 0; kernel < 7; ++kernel) {
    for (std::int64_t primitive = 0; primitive < 5; ++primitive) {
      const bool diverges = primitive == 4 && (kernel == 2 || kernel == 3);
      if (diverges) continue;
      for (const std::int64_t batch : {1, static_cast<int>(kBlock)}) {
        for (const Isa isa : available_isas()) {
          benchmark::RegisterBenchmark("jet", evaluate_term)
              ->Args({kernel, primitive, batch, static_cast<std::int64_t>(isa)});
        }
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  cs2mesh::register_cells();
  cs2mesh::register_point_sums();
  benchmark::RunSpecifiedBenchmarks();
}
