// CGAL's Delaunay refinement of an implicit surface (make_surface_mesh) as a peer in benchmarks.
#pragma once

#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh::bench {

struct CgalPeerOptions {
  double facet_distance = 0.0;  ///< scene units
  double facet_angle = 30.0;    ///< degrees, lower bound
  /// Initial points of CGAL's refinement; it only finds components that these meet.
  int initial_points = 20;
  /// A point with F > 0, required by CGAL for the centre of the bounding sphere.
  Vec3d inside;
  double bounding_radius = 0.0;
};

TriangleMesh cgal_make_surface_mesh(const ImplicitSurface& surface, const CgalPeerOptions& options);

}  // namespace cs2mesh::bench
