// The quadric: all points where a polynomial of second degree is not above 0.
#pragma once

#include <optional>

#include "libfield/base/aabb.h"
#include "libfield/base/jet2.h"

namespace cs2mesh {

/// q(p) = p^T square p + linear . p + constant; inside where q <= 0. The product of x and y has the
/// coefficient 2 square.xy.
struct Quadric {
  Symmetric3 square;
  Vec3d linear;
  double constant = 0.0;
  std::optional<Aabb> bounds;  ///< what of it counts, in its own coordinates
};

/// q with its derivatives.
Jet2 evaluate(const Quadric& quadric, const Vec3d& p);

/// q(map(p)) as a polynomial of p; without bounds.
Quadric substituted(const Quadric& quadric, const Affine& map);

/// What a quadric looks like. Coefficients within 1e-12 of the largest count as 0.
struct QuadricForm {
  Mat3 axis;         ///< rows: unit vectors, the principal axes
  Vec3d curvature;   ///< eigenvalues of `square`, 0 where they count as 0
  Vec3d center;      ///< where q is stationary along the axes of curvature
  double value = 0;  ///< q(center), 0 where it counts as 0
  Vec3d slope;       ///< the gradient there: across the curved axes, 0 unless q is parabolic
};
QuadricForm form_of(const Quadric& quadric);

/// Whether q < 0 nowhere.
bool has_no_inside(const QuadricForm& form);
/// A box around the inside; unbounded sides where the inside is, or may be, unbounded.
Aabb bounds(const QuadricForm& form);
/// How thin it is where it is thinnest: the least half axis or radius of curvature of its middle; 0
/// where it has none, as at the tip of a cone.
double least_radius(const QuadricForm& form);

}  // namespace cs2mesh
