// What the adaptive mesher's octree asks of a field, with proof and without: cells, bounds and
// processor time, and the first mesh it leads to.
//
//   octree_bench SCENE TOLERANCE [prove | trust]
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "polygonize/check.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/tolerance.h"
#include "tests/bench/bench_scene.h"

namespace cs2mesh {
namespace {

using bench::processor_seconds;

int run(const char* path, double tolerance, bool prove) {
  const Result<CompiledScene> compiled = bench::compile_file(path);
  if (!compiled) return 2;
  const Part& part = compiled->parts.front();
  SurfaceOctreeOptions options;
  options.tolerance = tolerance;
  options.prove = prove;
  options.smallest = std::min(0.35 * tolerance, part.thinnest_radius / 64);
  if (!prove) {
    const double cell = expected_cell(part.thinnest_radius, part.creased, tolerance);
    options.largest = 0.8 * cell;
    options.smallest = std::clamp(0.35 * tolerance, 0.25 * cell, 0.4 * cell);
  }
  const double start = processor_seconds();
  const Result<SurfaceOctree> tree = SurfaceOctree::build(*part.surface, options);
  if (!tree) {
    std::fprintf(stderr, "%s\n", to_string(tree.diagnostics().front()).c_str());
    return 3;
  }
  const double seconds = processor_seconds() - start;
  std::size_t kinds[3] = {};
  for (Octree::Index i = 0; i < tree->octree().size(); ++i) {
    if (tree->octree().is_leaf(i)) ++kinds[static_cast<std::size_t>(tree->kind(i))];
  }
  const SurfaceOctree::Counts& counts = tree->counts();
  const OctreeMesh first = mesh_octree(*part.surface, *tree);
  CheckOptions checks;
  checks.self_intersections = false;
  const MeshReport report = check(first.mesh, checks);
  std::printf("%s: %zu primitives, tolerance %g, cheap bounds: %s\n", path, part.primitive_count,
              tolerance, part.surface->has_cheap_bounds() ? "yes" : "no");
  std::printf("%10.2f s cpu %10zu jets %10zu enclosures %10zu slopes\n", seconds, counts.gradients,
              counts.enclosures, counts.slopes);
  std::printf(
      "%10zu empty leaves %10zu simple %10zu open (%.3f %%) %10zu triangles, %zu "
      "components, genus %lld\n",
      kinds[0], kinds[1], kinds[2],
      100.0 * static_cast<double>(kinds[2]) /
          static_cast<double>(std::max<std::size_t>(1, kinds[1] + kinds[2])),
      report.triangles, report.components, report.genus);
  return 0;
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: octree_bench SCENE TOLERANCE [prove | trust]\n");
    return 2;
  }
  return cs2mesh::run(argv[1], std::strtod(argv[2], nullptr),
                      argc < 4 || std::string_view(argv[3]) == "prove");
}
