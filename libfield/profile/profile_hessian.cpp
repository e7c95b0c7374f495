#include "libfield/profile/profile_hessian.h"

#include <numbers>

#include "libfield/profile/cone_weight.h"

namespace cs2mesh {
namespace {

/// F''(x), where F takes that value: the functions of the language are piecewise linear or
/// harmonic.
double second_derivative(ProfileFunction function, double x, double value) {
  constexpr double kSquaredPi = std::numbers::pi * std::numbers::pi;
  switch (function) {
    case ProfileFunction::sin:
    case ProfileFunction::cos:
      return -kSquaredPi * value;
    case ProfileFunction::sin_squared:
    case ProfileFunction::cos_squared:
      return 2.0 * kSquaredPi * (1.0 - 2.0 * value);
    default:
      return is_of_cones(function) ? cone_function(function, x).curvature : 0.0;
  }
}

}  // namespace

ProfileHessian profile_hessian(const StrengthProfile& profile, double u, double v) {
  const double su = profile.scale_u, sv = profile.scale_v;
  const double x = su * u + profile.translate_u, y = sv * v + profile.translate_v;
  const auto fu = any_function(profile.along_u, x);
  const auto fv = any_function(profile.along_v, y);
  const double w = profile.times * fu.value * fv.value;
  if (w < profile.lower || w > profile.upper) return {};
  return {profile.times * su * su * second_derivative(profile.along_u, x, fu.value) * fv.value,
          profile.times * su * sv * fu.slope * fv.slope,
          profile.times * sv * sv * fu.value * second_derivative(profile.along_v, y, fv.value)};
}

}  // namespace cs2mesh
