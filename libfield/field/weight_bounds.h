// Bounds of the product w(u, v) of a term's strength profiles, and of its gradient, over a box.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "libfield/base/interval.h"
#include "libfield/base/product_bound.h"
#include "libfield/field/box_view.h"
#include "libfield/primitive/uv_bends.h"
#include "libfield/primitive/uv_gradient.h"
#include "libfield/profile/profile_bends.h"
#include "libfield/profile/profile_slopes.h"

namespace cs2mesh {

template <class P>
Interval weight_range(const Term& term, const P& primitive, const Aabb& local) {
  const auto [u, v] = enclose_uv(chart_of(term, primitive), local);
  return enclose(term.profiles, u, v);
}

/// Whether w may differ between the two sides of a seam of u or v that the box straddles. The clamp
/// can hide a difference only where the other coordinate plays no part.
inline bool jumps(const StrengthProfile& profile, const UvGradientBound& uv) {
  StrengthProfile ends = profile;
  const bool u_alone = profile.along_v == ProfileFunction::one;
  const bool v_alone = profile.along_u == ProfileFunction::one;
  if (!u_alone && !v_alone) {
    ends.lower = -std::numeric_limits<double>::infinity();
    ends.upper = std::numeric_limits<double>::infinity();
  }
  ends.along_v = ProfileFunction::one;
  if (uv.seam_u && evaluate(ends, 0, 0).w != evaluate(ends, 1, 0).w) return true;
  ends.along_v = profile.along_v;
  ends.along_u = ProfileFunction::one;
  return uv.seam_v && evaluate(ends, 0, 0).w != evaluate(ends, 0, 1).w;
}

/// Bounds of w and of each component of grad w over a box.
struct WeightBound {
  Interval w;
  std::array<Interval, 3> gradient;
};

template <class P>
WeightBound weight_bound(const Term& term, const P& primitive, const LocalBox& local) {
  const auto [u, v] = enclose_uv(chart_of(term, primitive), local.box);
  const UvGradientBound slopes = enclose_uv_gradient(chart_of(term, primitive), local.box);
  WeightBound b;
  b.w = enclose(term.profiles, u, v);
  const bool jump = std::any_of(term.profiles.begin(), term.profiles.end(),
                                [&](const StrengthProfile& p) { return jumps(p, slopes); });
  if (jump) {
    b.gradient.fill(Interval::everything());
    return b;
  }
  Interval du(0.0), dv(0.0), w(1.0);
  for (const StrengthProfile& profile : term.profiles) {
    const Interval one = enclose(profile, u, v);
    const ProfileSlopes slope = enclose_slopes(profile, u, v);
    du = du * one + w * slope.du;
    dv = dv * one + w * slope.dv;
    w = w * one;
  }
  // A coordinate that plays no part does not matter where its gradient has no bound.
  const auto plays = [&](ProfileFunction StrengthProfile::*along) {
    return std::any_of(term.profiles.begin(), term.profiles.end(),
                       [&](const StrengthProfile& p) { return p.*along != ProfileFunction::one; });
  };
  if (plays(&StrengthProfile::along_u)) {
    for (std::size_t axis = 0; axis < 3; ++axis) b.gradient[axis] = du * slopes.u[axis];
  }
  if (plays(&StrengthProfile::along_v)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      b.gradient[axis] = b.gradient[axis] + dv * slopes.v[axis];
    }
  }
  return b;
}

/// Upper bounds of |w|, |grad w| and |D^2 w| over a box; infinite where they are not bounded.
struct WeightBends {
  double w = 1.0, slope = 0.0, bend = 0.0;
};

namespace detail {

inline double magnitude(const std::array<Interval, 3>& v) {
  return norm(Vec3d{v[0].magnitude(), v[1].magnitude(), v[2].magnitude()}) * (1 + 1e-14);
}

}  // namespace detail

template <class P>
WeightBends weight_bends(const Term& term, const P& primitive, const LocalBox& local) {
  const P chart = chart_of(term, primitive);
  const auto [u, v] = enclose_uv(chart, local.box);
  const UvGradientBound gradients = enclose_uv_gradient(chart, local.box);
  const UvBends bends = bound_uv_bends(chart, local.box);
  const double gu = detail::magnitude(gradients.u), gv = detail::magnitude(gradients.v);
  WeightBends all;
  for (const StrengthProfile& profile : term.profiles) {
    const bool by_u = profile.along_u != ProfileFunction::one;
    const bool by_v = profile.along_v != ProfileFunction::one;
    const ProfileSlopes slopes = enclose_slopes(profile, u, v);
    const ProfileBends second = bound_bends(profile, u, v);
    const double du = by_u ? slopes.du.magnitude() : 0.0;
    const double dv = by_v ? slopes.dv.magnitude() : 0.0;
    const double w = enclose(profile, u, v).magnitude();
    const double slope = product_bound(du, gu) + product_bound(dv, gv);
    const double bend = product_bound(second.uu, product_bound(gu, gu)) +
                        2 * product_bound(second.uv, product_bound(gu, gv)) +
                        product_bound(second.vv, product_bound(gv, gv)) +
                        product_bound(du, bends.u) + product_bound(dv, bends.v);
    all = {product_bound(all.w, w), product_bound(all.slope, w) + product_bound(all.w, slope),
           product_bound(all.bend, w) + 2 * product_bound(all.slope, slope) +
               product_bound(all.w, bend)};
  }
  return all;
}

/// The weight, if it is constant over the box, as between the corners of a clamped profile.
template <class P>
std::optional<Interval> flat_weight(const Term& term, const P& primitive, const LocalBox& local) {
  const WeightBound weight = weight_bound(term, primitive, local);
  for (const Interval& component : weight.gradient) {
    if (component.magnitude() > std::numeric_limits<double>::min()) return std::nullopt;
  }
  return weight.w;
}

}  // namespace cs2mesh
