#include "libfield/profile/profile_bends.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/product_bound.h"
#include "libfield/profile/cone_weight.h"
#include "libfield/profile/profile_slopes.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether an integer lies in k [lo, hi].
bool holds_multiple(const Interval& x, double k) {
  return std::floor(k * x.hi) >= k * x.lo;
}

/// An upper bound of |F''| over x.
double bend(ProfileFunction function, const Interval& x) {
  constexpr double kSquaredPi = std::numbers::pi * std::numbers::pi * (1 + 1e-15);
  switch (function) {
    case ProfileFunction::one:
    case ProfileFunction::x:
      return 0.0;
    case ProfileFunction::saw:
      return holds_multiple(x, 1.0) ? kInfinity : 0.0;
    case ProfileFunction::step:
    case ProfileFunction::hat:
      return holds_multiple(x, 2.0) ? kInfinity : 0.0;
    case ProfileFunction::sin:
    case ProfileFunction::cos:
      return kSquaredPi;
    case ProfileFunction::sin_squared:
    case ProfileFunction::cos_squared:
      return 2 * kSquaredPi;
    case ProfileFunction::cone_cauchy:
    case ProfileFunction::cone_gaussian:
      // (1 + x^2)^(3/2) and exp(x^2) but for a factor: their second derivatives grow with |x|.
      return (1 + 1e-11) * cone_function(function, x.magnitude()).curvature;
    default:
      return kInfinity;
  }
}

}  // namespace

ProfileBends bound_bends(const StrengthProfile& profile, const Interval& u, const Interval& v) {
  const Interval x = Interval(profile.scale_u) * u + Interval(profile.translate_u);
  const Interval y = Interval(profile.scale_v) * v + Interval(profile.translate_v);
  StrengthProfile plain = profile;
  plain.lower = -kInfinity;
  plain.upper = kInfinity;
  const Interval w = enclose(plain, u, v);
  if (w.hi < profile.lower || w.lo > profile.upper) return {};
  if (!(profile.lower < w.lo && w.hi < profile.upper)) return {kInfinity, kInfinity, kInfinity};
  // With one of the functions 1, the profile is the other one, and its slopes are that one's.
  const auto alone = [&](bool along_u) {
    StrengthProfile one = plain;
    (along_u ? one.along_v : one.along_u) = ProfileFunction::one;
    return one;
  };
  const StrengthProfile along_u = alone(true), along_v = alone(false);
  const double times = std::abs(profile.times);
  const double fu = enclose(along_u, u, v).magnitude(), fv = enclose(along_v, u, v).magnitude();
  const double du =
      profile.along_u == ProfileFunction::one ? 0.0 : enclose_slopes(along_u, u, v).du.magnitude();
  const double dv =
      profile.along_v == ProfileFunction::one ? 0.0 : enclose_slopes(along_v, u, v).dv.magnitude();
  const double su = profile.scale_u, sv = profile.scale_v;
  // fu, fv, du and dv each have `times` in them already.
  return {product_bound(product_bound(su * su, bend(profile.along_u, x)), fv),
          times > 0 ? product_bound(du, dv) / times : 0.0,
          product_bound(product_bound(sv * sv, bend(profile.along_v, y)), fu)};
}

}  // namespace cs2mesh
