// Bounds of the derivatives of a strength profile.
#pragma once

#include "libfield/profile/profile.h"

namespace cs2mesh {

/// Each contains every one-sided derivative of w over the given ranges, and so every difference
/// quotient between two of their points; infinite where w jumps.
struct ProfileSlopes {
  Interval du, dv;
};
ProfileSlopes enclose_slopes(const StrengthProfile& profile, const Interval& u, const Interval& v);

}  // namespace cs2mesh
