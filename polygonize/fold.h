// Triangles that are folded onto their neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

using TriangleCorners = std::array<Vec3d, 3>;

/// Whether a triangle faces the way of the surface at each of its corners: the cosine between its
/// normal and each of theirs, which are of length 1, is above `least`.
inline bool faces_normals(std::span<const Vec3d> positions, std::span<const Vec3d> normals,
                          const std::array<std::uint32_t, 3>& t, double least) {
  const Vec3d &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
  const Vec3d area = cross(b - a, c - a);
  const double most = least * norm(area);
  return dot(area, normals[t[0]]) > most && dot(area, normals[t[1]]) > most &&
         dot(area, normals[t[2]]) > most;
}

/// Whether a triangle faces the way of the surface at its middle, give or take 72 degrees. One jet.
bool faces_outward(const ImplicitSurface& surface, const TriangleCorners& triangle);

/// Whether two triangles at an edge are folded onto each other: their normals are nearly opposite,
/// of a cosine of `sharpest` at most, and one of them does not face the way of the surface. In a
/// groove, however sharp, both do. Without area counts as folded. A jet each, where
/// normals are nearly opposite.
bool folded(const ImplicitSurface& surface, const TriangleCorners& one,
            const TriangleCorners& other, double sharpest);

}  // namespace cs2mesh
