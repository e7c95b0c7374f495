// Triangles that are folded onto their neighbours.
#pragma once

#include <array>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

using TriangleCorners = std::array<Vec3d, 3>;

/// Whether a triangle faces the way of the surface at its middle, give or take 72 degrees. One jet.
bool faces_outward(const ImplicitSurface& surface, const TriangleCorners& triangle);

/// Whether two triangles at an edge are folded onto each other: their normals are nearly opposite,
/// of a cosine of `sharpest` at most, and one of them does not face the way of the surface. In a
/// groove, however sharp, both do. Without area counts as folded. A jet each, where
/// normals are nearly opposite.
bool folded(const ImplicitSurface& surface, const TriangleCorners& one,
            const TriangleCorners& other, double sharpest);

}  // namespace cs2mesh
