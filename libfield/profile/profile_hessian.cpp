#include "libfield/profile/profile_hessian.h"

#include <numbers>

#include "libfield/profile/along.h"

namespace cs2mesh {
namespace {

/// F'' where F takes that value: the functions are piecewise linear or harmonic.
double second_derivative(ProfileFunction function, double value) {
  constexpr double kSquaredPi = std::numbers::pi * std::numbers::pi;
  switch (function) {
    case ProfileFunction::sin:
    case ProfileFunction::cos:
      return -kSquaredPi * value;
    case ProfileFunction::sin_squared:
    case ProfileFunction::cos_squared:
      return 2.0 * kSquaredPi * (1.0 - 2.0 * value);
    default:
      return 0.0;
  }
}

}  // namespace

ProfileHessian profile_hessian(const StrengthProfile& profile, double u, double v) {
  const double su = profile.scale_u, sv = profile.scale_v;
  const auto fu = profile_function(profile.along_u, su * u + profile.translate_u);
  const auto fv = profile_function(profile.along_v, sv * v + profile.translate_v);
  const double w = profile.times * fu.value * fv.value;
  if (w < profile.lower || w > profile.upper) return {};
  return {profile.times * su * su * second_derivative(profile.along_u, fu.value) * fv.value,
          profile.times * su * sv * fu.slope * fv.slope,
          profile.times * sv * sv * fu.value * second_derivative(profile.along_v, fv.value)};
}

}  // namespace cs2mesh
