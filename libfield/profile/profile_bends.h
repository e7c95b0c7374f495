// Bounds of the second derivatives of a strength profile.
#pragma once

#include "libfield/profile/profile.h"

namespace cs2mesh {

/// Upper bounds of |w_uu|, |w_uv| and |w_vv| over the given ranges; infinite where w may have a
/// corner or jump, and for the functions of cones of kernels that end.
struct ProfileBends {
  double uu = 0.0, uv = 0.0, vv = 0.0;
};
ProfileBends bound_bends(const StrengthProfile& profile, const Interval& u, const Interval& v);

}  // namespace cs2mesh
