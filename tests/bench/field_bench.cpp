// Cost of one evaluation (value and gradient) of each kernel on each primitive. Times of different
// cells are comparable within one run.
#include <benchmark/benchmark.h>

#include "libfield/base/random.h"
#include "libfield/field/term.h"

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

void evaluate_term(benchmark::State& state) {
  const auto kind = kAllKernels[static_cast<std::size_t>(state.range(0))];
  Term term;
  term.kernel = make_kernel(kind, 3.0, 1.0, 0.0, 0.0);
  term.primitive = unit_primitive(static_cast<std::size_t>(state.range(1)));
  term.frame = frame_of(term.primitive);
  std::vector<Vec3d> points;
  Random random(1);
  for (int i = 0; i < 512; ++i) {
    points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  }
  std::vector<Jet> sums(points.size());
  for (auto _ : state) {
    accumulate(term, points, sums);
    benchmark::DoNotOptimize(sums.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
  constexpr const char* kPrimitives[] = {"point", "segment", "arc", "triangle", "plane"};
  state.SetLabel(std::string(name_of(kind)) + " x " + kPrimitives[state.range(1)]);
}

void register_cells() {
  for (std::int64_t kernel = 0; kernel < 7; ++kernel) {
    for (std::int64_t primitive = 0; primitive < 5; ++primitive) {
      const bool diverges = primitive == 4 && (kernel == 2 || kernel == 3);
      if (!diverges) {
        benchmark::RegisterBenchmark("jet", evaluate_term)->Args({kernel, primitive});
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  cs2mesh::register_cells();
  benchmark::RunSpecifiedBenchmarks();
}
