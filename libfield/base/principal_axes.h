// The eigenvalues and eigenvectors of a symmetric 3x3 matrix.
#pragma once

#include "libfield/base/jet2.h"

namespace cs2mesh {

/// m = sum of value[i] * axis.row[i] axis.row[i]^T; rows are unit vectors at right angles, in no
/// order. Cyclic Jacobi rotations; errors of a few ulp of the largest value. A matrix that is
/// diagonal keeps its axes to the last bit.
struct PrincipalAxes {
  Mat3 axis;
  Vec3d value;
};
PrincipalAxes principal_axes(const Symmetric3& m);

}  // namespace cs2mesh
