// Strength profiles with their second derivatives.
#pragma once

#include "libfield/profile/profile.h"

namespace cs2mesh {

/// The second partial derivatives of w; where w has a corner or a jump, those of one side.
struct ProfileHessian {
  double uu = 0.0, uv = 0.0, vv = 0.0;
};
ProfileHessian profile_hessian(const StrengthProfile& profile, double u, double v);

}  // namespace cs2mesh
