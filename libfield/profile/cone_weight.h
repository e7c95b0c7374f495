// The weight along a soft cone: its field is that of its axis times 1 / I(r(u)), I the field of an
// infinite line, r(u) the radius of the cone at u (art-language 3).
#pragma once

#include "libfield/kernel/kind.h"
#include "libfield/profile/along.h"
#include "libfield/profile/profile.h"

namespace cs2mesh {

/// Whether it is one of the functions of cones, which have no names in the language.
constexpr bool is_of_cones(ProfileFunction function) {
  return function > ProfileFunction::cos_squared;
}

/// The profile w(u) = I(x) / I(x(u)) of a kernel, x(u) linear from `base` to `apex`, in widths of
/// the kernel, and x the greater of the two. For the inverse kernel there is none
/// (ContractViolation).
StrengthProfile cone_weight(KernelKind kind, double base, double apex);

/// 1 / I(|x|) of a kernel of width 1 with its derivatives; even, convex, and least at 0.
struct Bent {
  double value, slope, curvature;
};
Bent cone_function(ProfileFunction function, double x);

/// Any function, over one number.
Derived<double> any_function(ProfileFunction function, double x);

}  // namespace cs2mesh
