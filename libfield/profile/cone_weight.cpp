#include "libfield/profile/cone_weight.h"

#include <algorithm>
#include <cmath>

#include "libfield/base/check.h"
#include "libfield/integral/line_field.h"

namespace cs2mesh {
namespace {

/// The squared kernel's 1 / I is linear, which has a function of its own.
ProfileFunction function_of(KernelKind kind) {
  switch (kind) {
    case KernelKind::cauchy:
      return ProfileFunction::cone_cauchy;
    case KernelKind::gaussian:
      return ProfileFunction::cone_gaussian;
    case KernelKind::metaball:
      return ProfileFunction::cone_metaball;
    case KernelKind::soft:
      return ProfileFunction::cone_soft;
    case KernelKind::quartic:
      return ProfileFunction::cone_quartic;
    case KernelKind::squared:
      return ProfileFunction::x;
    case KernelKind::inverse:
      break;
  }
  require(false, "the inverse kernel diverges on an infinite line");
  return ProfileFunction::one;
}

KernelKind kernel_of(ProfileFunction function) {
  switch (function) {
    case ProfileFunction::cone_gaussian:
      return KernelKind::gaussian;
    case ProfileFunction::cone_metaball:
      return KernelKind::metaball;
    case ProfileFunction::cone_soft:
      return KernelKind::soft;
    case ProfileFunction::cone_quartic:
      return KernelKind::quartic;
    default:
      return KernelKind::cauchy;
  }
}

}  // namespace

StrengthProfile cone_weight(KernelKind kind, double base, double apex) {
  const double most = std::max(base, apex);
  StrengthProfile profile;
  profile.along_u = function_of(kind);
  profile.scale_u = apex - base;
  profile.translate_u = base;
  profile.times = kind == KernelKind::squared ? 1 / most : line_field(kind, most).value;
  return profile;
}

Bent cone_function(ProfileFunction function, double x) {
  const LineField line = line_field(kernel_of(function), std::abs(x));
  const double w = 1 / line.value;
  const double fall = line.slope * w;
  return {w, std::copysign(fall * w, x), (2 * fall * fall - line.curvature * w) * w};
}

Derived<double> any_function(ProfileFunction function, double x) {
  if (!is_of_cones(function)) return profile_function(function, x);
  const Bent bent = cone_function(function, x);
  return {bent.value, bent.slope};
}

}  // namespace cs2mesh
