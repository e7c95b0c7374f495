// Strength profiles along a primitive (thesis 3.3.4; art-language "Profiles"):
//   w(u, v) = clamp(times * Fu(scale_u u + translate_u) * Fv(scale_v v + translate_v), lo, hi).
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "libfield/base/interval.h"

namespace cs2mesh {

/// The functions of a texture's `Fu Fv` method, in the order of kProfileNames; then those along
/// soft cones, which have no names (cone_weight.h).
enum class ProfileFunction {
  one,
  x,
  saw,
  hat,
  step,
  sin,
  cos,
  sin_squared,
  cos_squared,
  cone_cauchy,
  cone_gaussian,
  cone_metaball,
  cone_soft,
  cone_quartic
};

inline constexpr std::array<std::string_view, 9> kProfileNames = {
    "one", "x", "saw", "hat", "step", "sin", "cos", "sin^2", "cos^2"};

std::optional<ProfileFunction> profile_function_of(std::string_view name);

struct StrengthProfile {
  ProfileFunction along_u = ProfileFunction::one;
  ProfileFunction along_v = ProfileFunction::one;
  double scale_u = 1.0, scale_v = 1.0;
  double translate_u = 0.0, translate_v = 0.0;
  double times = 1.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  friend bool operator==(const StrengthProfile&, const StrengthProfile&) = default;
};

/// w with its partial derivatives; where w has a corner or a jump, those of one side.
struct ProfileValue {
  double w = 1.0, du = 0.0, dv = 0.0;
};
ProfileValue evaluate(const StrengthProfile& profile, double u, double v);

/// Whether w may have corners or jumps where u and v run: by its functions, or by a clamp.
bool has_corners(const StrengthProfile& profile);

/// Contains w(u, v) for all u, v in the intervals.
Interval enclose(const StrengthProfile& profile, const Interval& u, const Interval& v);
/// As much of the product of all.
Interval enclose(std::span<const StrengthProfile> profiles, const Interval& u, const Interval& v);

}  // namespace cs2mesh
