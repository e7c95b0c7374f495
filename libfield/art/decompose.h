// An affine map as the transforms that the scene language has.
#pragma once

#include <vector>

#include "libfield/base/affine.h"

namespace cs2mesh {

struct TransformStep {
  enum class Kind { rotate, scale, translate };
  Kind kind = Kind::translate;
  Vec3d vector;          ///< axis, factors or shift
  double degrees = 0.0;  ///< of a rotation
};

/// At most four steps (rotate, scale, rotate, translate) whose product, first step first, is `map`
/// to a few ulp of its largest entry; none for the identity. `map` must be finite and invertible.
///
/// The singular value decomposition A = U S V^T by one-sided Jacobi rotations (Hestenes 1958);
/// mirroring goes into the sign of a factor.
std::vector<TransformStep> decompose(const Affine& map);

}  // namespace cs2mesh
