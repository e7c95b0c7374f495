// Meshes a scene with each of our meshers and with the peers that are built in, in one run on one
// thread each, and measures every mesh both ways against the exact surface.
//
//   mesh_bench [SCENE TOLERANCE [SAMPLES [MESHER]]]
//
// Without arguments: the spindle cowrie at 0.1 % of its diagonal. With a mesher, that alone.
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string_view>

#include "libfield/art/read_art.h"
#include "libfield/field/compile.h"
#include "polygonize/mesher.h"
#include "polygonize/metrology.h"
#if CS2MESH_WITH_CGAL
#include "tests/bench/cgal_peer.h"
#endif

namespace cs2mesh {
namespace {

double seconds() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

void print_row(const char* method, const ImplicitSurface& surface, std::size_t samples,
               const std::function<TriangleMesh()>& make) {
  const double start = seconds();
  const TriangleMesh mesh = make();
  const double time = seconds() - start;
  MeasureOptions options;
  options.samples = samples;
  options.certified_rays = samples / 100;
  const MeasuredError error = measure(surface, mesh, options);
  std::printf("%-24s %9.3f s %10zu triangles   mesh->surface %.3e   surface->mesh %.3e\n", method,
              time, mesh.triangles.size(), error.mesh_to_surface_max, error.surface_to_mesh_max);
  std::fflush(stdout);
}

/// A point with F > 0: the first of a lattice over the bounds.
Vec3d point_inside(const ImplicitSurface& surface) {
  const Aabb box = surface.bounds();
  for (int n = 8;; n *= 2) {
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3d f{(i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n};
      const Vec3d e = box.extent();
      const Vec3d p = box.min + Vec3d{f.x * e.x, f.y * e.y, f.z * e.z};
      if (surface.value(p) > 0) return p;
    }
  }
}

int run(const char* path, double tolerance, std::size_t samples, std::string_view only) {
  const Result<Scene> scene = read_art(path);
  if (!scene) {
    std::fprintf(stderr, "%s\n", to_string(scene.diagnostics().front()).c_str());
    return 2;
  }
  const Result<CompiledScene> compiled = compile(*scene);
  if (!compiled) {
    std::fprintf(stderr, "%s\n", to_string(compiled.diagnostics().front()).c_str());
    return 2;
  }
  const Part& part = compiled->parts.front();
  std::printf("%s: %zu primitives, tolerance %g\n", path, part.primitive_count, tolerance);

  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  MesherRequest request;
  request.tolerance = tolerance;
  request.thinnest_radius = part.thinnest_radius;
  request.creased = part.creased;
  for (const Mesher& mesher : meshers()) {
    if (!only.empty() && only != mesher.name) continue;
    print_row(mesher.name.data(), *part.surface, samples, [&] {
      const Result<MesherResult> made = mesher.mesh(*part.surface, request);
      return made ? made->mesh : TriangleMesh{};
    });
  }
  if (!only.empty()) return 0;
#if CS2MESH_WITH_CGAL
  print_row("CGAL make_surface_mesh", *part.surface, samples, [&] {
    bench::CgalPeerOptions options;
    options.facet_distance = tolerance;
    options.inside = point_inside(*part.surface);
    options.bounding_radius = 2 * part.surface->bounds().diagonal();
    return bench::cgal_make_surface_mesh(*part.surface, options).mesh;
  });
#endif
  return 0;
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  if (argc == 1)
    return cs2mesh::run(CS2MESH_SOURCE_DIR "/data/scenes/cowrie.art", 5.7e-3, 100000, {});
  if (argc < 3) {
    std::fprintf(stderr, "usage: mesh_bench [SCENE TOLERANCE [SAMPLES [MESHER]]]\n");
    return 2;
  }
  const std::size_t samples = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 100000;
  return cs2mesh::run(argv[1], std::strtod(argv[2], nullptr), samples, argc > 4 ? argv[4] : "");
}
