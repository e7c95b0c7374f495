// Profiles along the length of a primitive, over one number or packs: w(u) with its gradient, u
// running from 0 to 1 along a segment or an arc, clamped beyond its ends (art-language "Profiles").
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/integral/special.h"
#include "libfield/profile/profile.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {

/// A function of one variable with its derivative.
template <class T>
struct Derived {
  T value, slope;
};

/// F(x); where F has a corner or a jump, the derivative of one side. Not for the functions of
/// cones: any_function() of cone_weight.h knows those too, over one number.
template <class T>
Derived<T> profile_function(ProfileFunction function, const T& x) {
  using std::abs;
  constexpr double kPi = std::numbers::pi;
  switch (function) {
    case ProfileFunction::one:
      return {T(1), T(0)};
    case ProfileFunction::x:
      return {x, T(1)};
    case ProfileFunction::saw:
      return {x - vmath::floor(x), T(1)};
    case ProfileFunction::hat: {
      const T part = x - vmath::floor(x);
      return {T(1) - abs(T(2) * part - T(1)), select(part < T(0.5), T(2), T(-2))};
    }
    case ProfileFunction::step:
      return {select(x - vmath::floor(x) < T(0.5), T(0), T(1)), T(0)};
    case ProfileFunction::sin: {
      const auto at = vmath::sin_cos_pi(x);
      return {at.sine, T(kPi) * at.cosine};
    }
    case ProfileFunction::cos: {
      const auto at = vmath::sin_cos_pi(x);
      return {at.cosine, T(-kPi) * at.sine};
    }
    case ProfileFunction::sin_squared: {
      const auto at = vmath::sin_cos_pi(x);
      return {at.sine * at.sine, T(2.0 * kPi) * at.sine * at.cosine};
    }
    case ProfileFunction::cos_squared: {
      const auto at = vmath::sin_cos_pi(x);
      return {at.cosine * at.cosine, T(-2.0 * kPi) * at.sine * at.cosine};
    }
    default:
      break;
  }
  return {T(1), T(0)};
}

/// u with its gradient.
template <class T>
JetOf<T> along(const SegmentFrame<T>& segment, const Vec3<T>& point) {
  using std::max;
  using std::min;
  const auto extended = segment.length > T(0);
  const T inverse = T(1) / select(extended, segment.length, T(1));
  const T u = dot(point - segment.a, segment.axis) * inverse;
  const auto inside = (T(0) < u) & (u < T(1)) & extended;
  return {min(max(u, T(0)), T(1)), select(inside, T(1), T(0)) * inverse * segment.axis};
}

template <class T>
JetOf<T> along(const ArcFrame<T>& arc, const Vec3<T>& point) {
  using std::max;
  using std::min;
  const Vec3<T> d = point - arc.center;
  const T x = dot(d, arc.ex), y = dot(d, arc.ey);
  const T squared = x * x + y * y;
  const auto off_axis = squared > T(0);
  const T azimuth = select(off_axis, vmath::atan2(y, T(select(off_axis, x, T(1)))), T(0));
  const T u = azimuth / arc.sweep + T(0.5);
  const auto inside = (T(0) < u) & (u < T(1)) & off_axis;
  const T per_turn = select(inside, T(T(1) / (select(off_axis, squared, T(1)) * arc.sweep)), T(0));
  return {min(max(u, T(0)), T(1)), (per_turn * x) * arc.ey - (per_turn * y) * arc.ex};
}

/// w with its gradient, for a profile along u alone.
template <class T, class F>
JetOf<T> weight(const StrengthProfile& profile, const F& frame, const Vec3<T>& point) {
  const JetOf<T> u = along(frame, point);
  const T scale(profile.scale_u), times(profile.times);
  const Derived<T> f =
      profile_function(profile.along_u, T(scale * u.value + T(profile.translate_u)));
  const T w = times * f.value;
  const T lower(profile.lower), upper(profile.upper);
  const auto below = w < lower, above = upper < w;
  const T clamped = select(below, lower, T(select(above, upper, w)));
  return {clamped, select(below | above, T(0), T(times * scale * f.slope)) * u.gradient};
}

}  // namespace cs2mesh
