#include "libfield/profile/profile_slopes.h"

#include <cmath>
#include <numbers>

#include "libfield/profile/cone_weight.h"

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;

/// Contains cos over [lo, hi].
Interval enclose_cos(double lo, double hi) {
  const double slack = 1e-15 * (4 + std::abs(lo) + std::abs(hi));
  if (!(hi - lo < 2 * kPi) || !(slack < 1)) return {-1, 1};
  Interval range = hull(Interval(std::cos(lo)), Interval(std::cos(hi)));
  // Maxima at even, minima at odd multiples of pi.
  const double first = std::ceil((lo - slack) / kPi);
  for (double k = first; k * kPi <= hi + slack; k += 1) {
    range = hull(range, Interval(std::fmod(k, 2.0) == 0 ? 1.0 : -1.0));
  }
  return intersection(widened(range, slack), Interval(-1, 1));
}

/// Whether an integer lies in [lo, hi].
bool holds_integer(double lo, double hi) {
  return std::floor(hi) >= lo;
}

/// The functions of cones are convex: their slopes are between those at the ends. The kernels but
/// Cauchy's are logarithmically concave over the plane, and with them their integral along a line
/// (Prekopa 1973), so that 1 / I is logarithmically convex; Cauchy's is (1 + x^2)^(3/2).
Interval convex_slope(ProfileFunction function, const Interval& x) {
  if (!std::isfinite(x.lo) || !std::isfinite(x.hi)) return Interval::everything();
  const Interval range =
      hull(cone_function(function, x.lo).slope, cone_function(function, x.hi).slope);
  return widened(range, 1e-11 * range.magnitude());
}

/// Contains F' over x.
Interval slope(ProfileFunction function, const Interval& x) {
  switch (function) {
    case ProfileFunction::one:
      return 0.0;
    case ProfileFunction::x:
      return 1.0;
    case ProfileFunction::saw:
      return holds_integer(x.lo, x.hi) ? Interval::everything() : Interval(1.0);
    case ProfileFunction::step:
      return holds_integer(2 * x.lo, 2 * x.hi) ? Interval::everything() : Interval(0.0);
    case ProfileFunction::hat:
      if (holds_integer(2 * x.lo, 2 * x.hi)) return {-2, 2};
      return x.lo - std::floor(x.lo) < 0.5 ? 2.0 : -2.0;
    case ProfileFunction::sin:
      return Interval(kPi) * enclose_cos(kPi * x.lo, kPi * x.hi);
    case ProfileFunction::cos:  // (cos pi x)' = pi cos(pi x + pi/2)
      return Interval(kPi) * enclose_cos(kPi * (x.lo + 0.5), kPi * (x.hi + 0.5));
    case ProfileFunction::sin_squared:  // pi sin(2 pi x)
      return Interval(kPi) * enclose_cos(kPi * (2 * x.lo - 0.5), kPi * (2 * x.hi - 0.5));
    case ProfileFunction::cos_squared:
      return Interval(kPi) * enclose_cos(kPi * (2 * x.lo + 0.5), kPi * (2 * x.hi + 0.5));
    default:
      return convex_slope(function, x);
  }
}

/// Contains F over x, by way of the profile that is F alone.
Interval range(ProfileFunction function, const Interval& x) {
  StrengthProfile alone;
  alone.along_u = function;
  return enclose(alone, x, Interval(0.0));
}

}  // namespace

ProfileSlopes enclose_slopes(const StrengthProfile& profile, const Interval& u, const Interval& v) {
  const Interval x = Interval(profile.scale_u) * u + Interval(profile.translate_u);
  const Interval y = Interval(profile.scale_v) * v + Interval(profile.translate_v);
  const Interval fu = range(profile.along_u, x);
  const Interval fv = range(profile.along_v, y);
  const Interval times(profile.times);
  ProfileSlopes slopes{times * slope(profile.along_u, x) * fv * Interval(profile.scale_u),
                       times * slope(profile.along_v, y) * fu * Interval(profile.scale_v)};

  // Where the clamp holds, w is constant; where it may hold, a corner joins 0 and the slope.
  const Interval unclamped = times * fu * fv;
  if (unclamped.hi < profile.lower || unclamped.lo > profile.upper) return {0.0, 0.0};
  if (unclamped.lo < profile.lower || unclamped.hi > profile.upper) {
    slopes = {hull(slopes.du, 0.0), hull(slopes.dv, 0.0)};
  }
  return slopes;
}

}  // namespace cs2mesh
