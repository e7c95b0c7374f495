#include "tests/bench/mesh_methods.h"

#include <algorithm>

#include "polygonize/mesher.h"
#include "polygonize/part_request.h"
#include "tests/bench/vdb_peer.h"
#if CS2MESH_WITH_CGAL
#include "tests/bench/cgal_peer.h"
#endif
#if CS2MESH_WITH_VTK
#include "tests/bench/vtk_peer.h"
#endif

namespace cs2mesh::bench {
namespace {

template <std::size_t number>
TriangleMesh by_ours(const Part& part, double tolerance) {
  Result<MesherResult> made =
      meshers()[number].mesh(*part.surface, request_for(part, tolerance, nullptr));
  return made && made->reached ? std::move(made->mesh) : TriangleMesh{};
}

TriangleMesh by_vdb(const Part& part, double cell) {
  return vdb_level_set_mesh(*part.surface, cell);
}

#if CS2MESH_WITH_CGAL
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

TriangleMesh by_cgal(const Part& part, double distance) {
  CgalPeerOptions options;
  options.facet_distance = distance;
  options.inside = point_inside(*part.surface);
  options.bounding_radius = 2 * part.surface->bounds().diagonal();
  return cgal_make_surface_mesh(*part.surface, options);
}
#endif

#if CS2MESH_WITH_VTK
TriangleMesh by_vtk(const Part& part, double cell) {
  return vtk_flying_edges_mesh(*part.surface, cell);
}
#endif

constexpr MeshMethod kMethods[] = {
    {"adaptive", true, by_ours<0>},
    {"lattice", true, by_ours<1>},
    {"dual", true, by_ours<2>},
    {"vdb", true, by_ours<3>},
    {"OpenVDB volumeToMesh", false, by_vdb, 4.0},
#if CS2MESH_WITH_VTK
    {"VTK flying edges", false, by_vtk, 4.0, 4.0},
#endif
#if CS2MESH_WITH_CGAL
    {"CGAL make_surface_mesh", false, by_cgal, 0.5},
#endif
};

}  // namespace

std::span<const MeshMethod> mesh_methods() {
  return kMethods;
}

const MeshMethod* find_mesh_method(std::string_view name) {
  const auto* const found =
      std::find_if(std::begin(kMethods), std::end(kMethods),
                   [name](const MeshMethod& method) { return method.name == name; });
  return found == std::end(kMethods) ? nullptr : found;
}

}  // namespace cs2mesh::bench
