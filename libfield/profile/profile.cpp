#include "libfield/profile/profile.h"

#include <algorithm>
#include <cmath>

#include "libfield/profile/cone_weight.h"

namespace cs2mesh {

std::optional<ProfileFunction> profile_function_of(std::string_view name) {
  for (std::size_t i = 0; i < kProfileNames.size(); ++i) {
    if (kProfileNames[i] == name) return static_cast<ProfileFunction>(i);
  }
  return std::nullopt;
}

namespace {

// Of the functions of cones, relative: the closed forms lose digits near the edge of a support.
constexpr double kConeRounding = 1e-11;

// Whether some offset + k * period, k an integer, lies in x, or within rounding of it.
bool meets(const Interval& x, double offset, double period) {
  const double slack = 1e-14 * (1.0 + x.magnitude());
  const double first = std::ceil((x.lo - slack - offset) / period);
  return offset + first * period <= x.hi + slack;
}

// All values of a function.
Interval range_of(ProfileFunction function) {
  switch (function) {
    case ProfileFunction::one:
      return 1.0;
    case ProfileFunction::x:
      return Interval::everything();
    case ProfileFunction::sin:
    case ProfileFunction::cos:
      return {-1.0, 1.0};
    default:
      return is_of_cones(function) ? Interval(0.0, std::numeric_limits<double>::infinity())
                                   : Interval(0.0, 1.0);
  }
}

// The hull of the values at the ends and of those the function takes or approaches between.
Interval enclose(ProfileFunction function, const Interval& x) {
  if (!std::isfinite(x.lo) || !std::isfinite(x.hi)) return range_of(function);
  Interval range = hull(any_function(function, x.lo).value, any_function(function, x.hi).value);
  const auto include_at = [&](double offset, double period, double value) {
    if (meets(x, offset, period)) range = hull(range, value);
  };
  switch (function) {
    case ProfileFunction::one:
    case ProfileFunction::x:
      return range;
    case ProfileFunction::saw:
      if (meets(x, 0.0, 1.0)) return {0.0, 1.0};
      break;
    case ProfileFunction::step:
      if (meets(x, 0.0, 0.5)) return {0.0, 1.0};
      break;
    case ProfileFunction::hat:
    case ProfileFunction::sin_squared:
      include_at(0.0, 1.0, 0.0);
      include_at(0.5, 1.0, 1.0);
      break;
    case ProfileFunction::cos_squared:
      include_at(0.0, 1.0, 1.0);
      include_at(0.5, 1.0, 0.0);
      break;
    case ProfileFunction::sin:
      include_at(0.5, 2.0, 1.0);
      include_at(-0.5, 2.0, -1.0);
      break;
    case ProfileFunction::cos:
      include_at(0.0, 2.0, 1.0);
      include_at(1.0, 2.0, -1.0);
      break;
    default:
      if (x.contains(0.0)) range = hull(range, any_function(function, 0.0).value);
      return widened(range, kConeRounding * range.magnitude());
  }
  return widened(range, 1e-14 * (1.0 + x.magnitude()));
}

}  // namespace

ProfileValue evaluate(const StrengthProfile& profile, double u, double v) {
  const auto fu = any_function(profile.along_u, profile.scale_u * u + profile.translate_u);
  const auto fv = any_function(profile.along_v, profile.scale_v * v + profile.translate_v);
  const double w = profile.times * fu.value * fv.value;
  if (w < profile.lower) return {profile.lower, 0.0, 0.0};
  if (w > profile.upper) return {profile.upper, 0.0, 0.0};
  return {w, profile.times * profile.scale_u * fu.slope * fv.value,
          profile.times * profile.scale_v * fu.value * fv.slope};
}

Interval enclose(const StrengthProfile& profile, const Interval& u, const Interval& v) {
  const Interval x = Interval(profile.scale_u) * u + Interval(profile.translate_u);
  const Interval y = Interval(profile.scale_v) * v + Interval(profile.translate_v);
  const Interval product =
      Interval(profile.times) * enclose(profile.along_u, x) * enclose(profile.along_v, y);
  // The order of the two clamps is that of evaluate, should lower exceed upper.
  const auto clamp = [&](double w) {
    return w < profile.lower ? profile.lower : std::min(w, profile.upper);
  };
  return hull(clamp(product.lo), clamp(product.hi));
}

Interval enclose(std::span<const StrengthProfile> profiles, const Interval& u, const Interval& v) {
  Interval all(1.0);
  for (const StrengthProfile& profile : profiles) all = all * enclose(profile, u, v);
  return all;
}

bool has_corners(const StrengthProfile& profile) {
  const auto cornered = [](ProfileFunction function) {
    return function == ProfileFunction::saw || function == ProfileFunction::hat ||
           function == ProfileFunction::step;
  };
  return cornered(profile.along_u) || cornered(profile.along_v) || std::isfinite(profile.lower) ||
         std::isfinite(profile.upper);
}

}  // namespace cs2mesh
