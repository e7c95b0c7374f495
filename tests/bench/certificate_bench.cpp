// Meshes a scene with the adaptive mesher and certifies the mesh, as it is and cut where that
// helps: the shares, what is in doubt in the end, and what the certificates cost beside the
// meshing, in processor time on one thread.
//
//   certificate_bench SCENE TOLERANCE [PART_OF_THE_TOLERANCE_TO_MESH_WITH]
#include <tbb/global_control.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "polygonize/certificate.h"
#include "polygonize/check.h"
#include "polygonize/mesher.h"
#include "polygonize/part_request.h"
#include "tests/bench/bench_scene.h"

namespace cs2mesh {
namespace {

using bench::processor_seconds;

int run(const char* path, double tolerance, double aim) {
  const Result<CompiledScene> compiled = bench::compile_file(path);
  if (!compiled) return 2;
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  if (tolerance < 0) tolerance *= -compiled->extent.diagonal();
  for (const Part& part : compiled->parts) {
    const double start = processor_seconds();
    const MesherRequest request = request_for(part, aim * tolerance, nullptr);
    const Result<MesherResult> made = meshers().front().mesh(*part.surface, request);
    if (!made) continue;
    const double meshed = processor_seconds();
    TopologyProof::Options proof;
    proof.smallest = request.thinnest_radius / 64;
    const Result<TopologyProof> topology = TopologyProof::build(*part.surface, proof);
    const double proven = processor_seconds();
    CertifyOptions options;
    options.tolerance = tolerance;
    Result<Certificate> result = topology ? certify(*part.surface, made->mesh, *topology, options)
                                          : Result<Certificate>::failure(topology.diagnostics());
    if (!result) continue;
    const double done = processor_seconds();
    std::printf(
        "%s %s tolerance %.3g: %zu triangles in %.2f s, topology %.2f s, certificate %.2f s: %.4f "
        "%%\n",
        path, part.name.c_str(), tolerance, made->mesh.triangles.size(), meshed - start,
        proven - meshed, done - proven, 100 * result->share());
    TriangleMesh mesh = made->mesh;
    result = certify_refined(*part.surface, mesh, *topology, options);
    if (!result) continue;
    const double refined = processor_seconds();
    std::array<std::size_t, 6> count{};
    std::array<double, 6> area{};
    for (const UncertifiedPlace& place : result->places) {
      ++count[static_cast<std::size_t>(place.doubt)];
      area[static_cast<std::size_t>(place.doubt)] += place.area;
    }
    const double n = static_cast<double>(mesh.triangles.size());
    std::printf(
        "  refined: %zu triangles in %.2f s: %.4f %%; values, gradients, bounds a triangle: %.1f "
        "%.1f %.2f\n",
        mesh.triangles.size(), refined - done, 100 * result->share(),
        static_cast<double>(result->values) / n, static_cast<double>(result->gradients) / n,
        static_cast<double>(result->bounds) / n);
    CheckOptions unchecked;
    unchecked.self_intersections = false;
    const MeshReport report = check(mesh, unchecked);
    std::printf("  components %zu genus %lld; open cells %zu\n", report.components, report.genus,
                topology->open().size());
    for (std::size_t k = 1; k < count.size(); ++k) {
      std::printf("  %s: %zu places, %.4f %% of the area\n", name(static_cast<Doubt>(k)).data(),
                  count[k], 100 * area[k] / result->area);
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(result->places.size(), 6); ++i) {
      const UncertifiedPlace& place = result->places[i];
      std::printf("    %s (%.6g, %.6g, %.6g)\n", name(place.doubt).data(), place.position.x,
                  place.position.y, place.position.z);
    }
  }
  return 0;
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: certificate_bench SCENE TOLERANCE [PART]\n"
                 "a tolerance below 0 is a part of the diagonal, as -0.001\n");
    return 2;
  }
  return cs2mesh::run(argv[1], std::strtod(argv[2], nullptr),
                      argc > 3 ? std::strtod(argv[3], nullptr) : 1.0);
}
