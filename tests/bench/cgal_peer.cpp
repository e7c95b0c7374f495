#include "tests/bench/cgal_peer.h"

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/IO/facets_in_complex_2_to_triangle_mesh.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>

namespace cs2mesh::bench {
namespace {

using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
using Complex = CGAL::Complex_2_in_triangulation_3<Triangulation>;
using Traits = Triangulation::Geom_traits;

/// CGAL's convention: negative inside.
struct NegatedField {
  const ImplicitSurface* surface;
  Traits::FT operator()(const Traits::Point_3& p) const {
    return -surface->value({p.x(), p.y(), p.z()});
  }
};

TriangleMesh to_mesh(const Complex& complex) {
  CGAL::Surface_mesh<Traits::Point_3> surface_mesh;
  CGAL::facets_in_complex_2_to_triangle_mesh(complex, surface_mesh);
  TriangleMesh mesh;
  for (const auto v : surface_mesh.vertices()) {
    const auto& p = surface_mesh.point(v);
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : surface_mesh.faces()) {
    std::array<TriangleMesh::Index, 3> triangle{};
    std::size_t corner = 0;
    for (const auto v : surface_mesh.vertices_around_face(surface_mesh.halfedge(f))) {
      triangle[corner++] = static_cast<TriangleMesh::Index>(static_cast<std::size_t>(v));
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

TriangleMesh cgal_make_surface_mesh(const ImplicitSurface& surface,
                                    const CgalPeerOptions& options) {
  Triangulation triangulation;
  Complex complex(triangulation);
  const Traits::Point_3 center(options.inside.x, options.inside.y, options.inside.z);
  const Traits::Sphere_3 sphere(center, options.bounding_radius * options.bounding_radius);
  const CGAL::Implicit_surface_3<Traits, NegatedField> implicit(NegatedField{&surface}, sphere,
                                                                1e-9);
  // No bound on the size of facets: the distance decides.
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(
      options.facet_angle, options.bounding_radius, options.facet_distance);
  CGAL::make_surface_mesh(complex, implicit, criteria, CGAL::Manifold_tag(),
                          options.initial_points);
  return to_mesh(complex);
}

}  // namespace cs2mesh::bench
