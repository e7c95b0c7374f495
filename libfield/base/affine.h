// Affine maps p -> A p + t.
#pragma once

#include <array>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// A 3x3 matrix by rows.
struct Mat3 {
  std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

  friend Vec3d operator*(const Mat3& m, const Vec3d& v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
  }
  friend Mat3 operator*(const Mat3& a, const Mat3& b);
  friend bool operator==(const Mat3&, const Mat3&) = default;
};

Mat3 transpose(const Mat3& m);
double determinant(const Mat3& m);
/// The inverse of a matrix whose determinant is not 0.
Mat3 inverse(const Mat3& m);
/// Upper bound of the operator 2-norm (largest stretch): the Frobenius norm, at most sqrt(3) too
/// large, unless m is a multiple of an orthogonal matrix, for which it is exact to rounding.
double stretch_bound(const Mat3& m);

struct Affine {
  Mat3 linear;
  Vec3d translation;

  Vec3d operator()(const Vec3d& p) const { return linear * p + translation; }
  friend Affine operator*(const Affine& a, const Affine& b) {
    return {a.linear * b.linear, a(b.translation)};
  }
  friend bool operator==(const Affine&, const Affine&) = default;

  bool is_identity() const { return *this == Affine{}; }
  static Affine translate(const Vec3d& t) { return {{}, t}; }
  static Affine scale(const Vec3d& s);
  /// Right-handed rotation about `axis` (not zero) through the origin by `degrees`.
  static Affine rotate(const Vec3d& axis, double degrees);
};

Affine inverse(const Affine& m);

/// The factor k > 0 if `m` is k times an orthogonal matrix (to 1e-12 relative), else 0.
double similarity_factor(const Mat3& m);

}  // namespace cs2mesh
