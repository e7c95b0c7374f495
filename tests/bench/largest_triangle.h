// How large a triangle may be that is to be near a surface: the optimum that meshes are told by.
#pragma once

namespace cs2mesh::bench {

/// The largest area of a triangle with no angle below `least_angle`, in degrees, that stays within
/// 1 of the quadric (x^2 + ratio y^2) / 2, measured along z, with its corners on the quadric or,
/// `balanced`, all of them off it by as much. On a surface with the principal curvatures k1 and k2,
/// |k2| <= |k1|, areas are so many times tolerance / |k1|, for ratio = k2 / k1 in [-1, 1]. Copies
/// of one triangle tile the plane, so that 1 / area is the least number of triangles an area
/// unless corners are off the surface by different amounts, which saves a little over saddles
/// (Atariah, Rote and Wintraecken, "Optimal triangulation of saddle surfaces", 2018).
///
/// Without a bound on angles that is 3 sqrt(3) / 2 / sqrt(ratio) for ratio > 0, of triangles that
/// are equilateral where lengths are measured by curvature, twice as much if balanced; and
/// 2 sqrt(5) / sqrt(-ratio) for ratio < 0 (Pottmann et al., "On piecewise linear approximation of
/// quadratic functions", 2000), balanced or not: of the edges of that triangle two are as far on
/// one side of the surface as the third on the other. Found by search over the shapes and turns of
/// triangles, in steps of a degree and two.
double largest_triangle(double ratio, double least_angle, bool balanced);

}  // namespace cs2mesh::bench
