// Cost of one evaluation (value and gradient) of each kernel on each primitive, for a single point
// and for the points of a lattice block, with every instruction set. Times of different cells are
// comparable within one run.
#include <benchmark/benchmark.h>

#include "libfield/base/random.h"
#include "libfield/field/term.h"
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
  benchmark::RunSpecifiedBenchmarks();
}
