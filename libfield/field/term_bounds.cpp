#include "libfield/field/term_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libfield/field/term_visit.h"
#include "libfield/integral/bound.h"
#include "libfield/primitive/uv_gradient.h"
#include "libfield/profile/profile_slopes.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// The closed forms and rules are tested to 64 ulp of backward error.
constexpr double kBackwardError = 64 * kEpsilon;

/// Longest edge over smallest height of a triangle, 1 for the others: how much the rounding of the
/// vertices is magnified.
double condition_number(const Point&) {
  return 1;
}
double condition_number(const Segment&) {
  return 1;
}
double condition_number(const TaperedSegment&) {
  return 1;
}
double condition_number(const Arc&) {
  return 1;
}
double condition_number(const Plane&) {
  return 1;
}
double condition_number(const Triangle& triangle) {
  const double longest = size(triangle);
  return std::min(longest * longest / (2 * measure(triangle)), 1e12);
}

/// A box in the coordinates of the primitive, as a ball about its centre.
struct LocalBox {
  Vec3d center;
  double radius = 0.0;   ///< half the diagonal, rounded up
  double stretch = 1.0;  ///< upper bound of |to_local|
  Aabb box;
};

double half_diagonal(const Aabb& box) {
  return 0.5 * box.diagonal() * (1 + 4 * kEpsilon);
}

LocalBox local_box(const Term& term, const Aabb& box) {
  const double half = half_diagonal(box);
  if (!term.to_local) return {box.center(), half, 1.0, box};
  LocalBox local;
  local.center = (*term.to_local)(box.center());
  local.stretch = stretch_bound(term.to_local->linear);
  local.radius = half * local.stretch;
  for (int corner = 0; corner < 8; ++corner)
    local.box.include((*term.to_local)(box.corner(corner)));
  return local;
}

/// As distance(arc, p), without an angle: p lies over the arc where cos(azimuth) >= cos(sweep / 2).
double nearest(const ArcFrame<double>& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double x = dot(d, arc.ex);
  const double y = std::abs(dot(d, arc.ey));
  const double z = dot(d, arc.normal);
  const double rho = std::sqrt(x * x + y * y);
  const double cosine = 2 * arc.cos_quarter * arc.cos_quarter - 1;
  if (x >= rho * cosine) return std::sqrt((rho - arc.radius) * (rho - arc.radius) + z * z);
  const double dx = x - arc.radius * cosine;
  const double dy = y - arc.radius * arc.sin_half;
  return std::sqrt(dx * dx + dy * dy + z * z);
}

template <class P>
double nearest(const Term& term, const P& primitive, const Vec3d& p) {
  if constexpr (std::is_same_v<P, Arc>) {
    return nearest(std::get<ArcFrame<double>>(term.frame), p);
  } else {
    return distance(primitive, p);
  }
}

/// Distances from a primitive to a ball, rounded outwards.
struct Reach {
  double near = 0.0, far = 0.0;
  double scale = 0.0;  ///< of the coordinates relative to the primitive
  double size = 0.0;   ///< of the primitive
};

template <class P>
Reach reach(const Term& term, const P& primitive, const LocalBox& local) {
  Reach r;
  r.size = size(primitive);
  const double d = nearest(term, primitive, local.center);
  r.scale = d + r.size;
  const double slack = local.radius + 16 * kEpsilon * (r.scale + local.radius);
  r.near = std::max(0.0, d - slack);
  r.far = r.scale + slack;
  return r;
}

/// derivative_bound() at the near distance; far from a primitive, its mass in the nearest place is
/// as good and cheaper.
template <class K, class P>
double near_bound(const K& kernel, const P& primitive, int order, const Reach& r) {
  if constexpr (!std::is_same_v<P, Plane>) {
    if (r.near > r.size) {
      return mass_bound(primitive) * kernel.derivative_envelope(order, r.near) * (1 + 1e-12);
    }
  }
  return derivative_bound(kernel, primitive, order, r.near);
}

/// Contains the integral alone.
template <class K, class P>
Interval integral_range(const K& kernel, const P& primitive, const Reach& r) {
  const double highest = near_bound(kernel, primitive, 0, r);
  // Every element of the primitive is nearer than r.far, and h decreases.
  const double mass = measure(primitive);
  const double lowest =
      std::isfinite(mass) ? mass * kernel.profile(r.far * r.far) * (1 - 1e-12) : 0.0;
  return {std::min(lowest, highest), highest};
}

/// Where the weight may be of both signs, int w h is between its least and its greatest value, or
/// 0, times int h. Where it is not negative, every element of it is nearer than r.far, as above.
template <class K>
Interval integral_range(const K& kernel, const TaperedSegment& segment, const Reach& r) {
  const SegmentWeight& w = segment.weight;
  if (std::min({w.b0, w.b1, w.b2}) >= 0) {
    const double highest = near_bound(kernel, segment, 0, r);
    const double mass = mean(w) * measure(segment);
    return {std::min(mass * kernel.profile(r.far * r.far) * (1 - 1e-12), highest), highest};
  }
  const double plain = near_bound(kernel, segment.axis, 0, r);
  const Interval weights = hull(range(w), 0.0);
  return {weights.lo * plain * (1 + 1e-12), weights.hi * plain * (1 + 1e-12)};
}

/// Value and gradient whose rounding is that of a field's, if they are greater than the field's
/// own: where a weight has coefficients of both signs, those of the field with their absolute
/// values.
struct RoundingSize {
  double value = 0.0, slope = 0.0;
};
template <class K, class P>
RoundingSize rounding_size(const K& /*kernel*/, const P& /*primitive*/, const Reach& /*r*/) {
  return {};
}
template <class K>
RoundingSize rounding_size(const K& kernel, const TaperedSegment& segment, const Reach& r) {
  const SegmentWeight& w = segment.weight;
  if (std::min({w.b0, w.b1, w.b2}) >= 0) return {};
  const double greatest = std::max({std::abs(w.b0), std::abs(w.b1), std::abs(w.b2)});
  return {greatest * near_bound(kernel, segment.axis, 0, r),
          greatest * near_bound(kernel, segment.axis, 1, r)};
}

template <class P>
Interval weight_range(const Term& term, const P& primitive, const Aabb& local) {
  const auto [u, v] = enclose_uv(primitive, local);
  return enclose(term.profiles, u, v);
}

/// Whether w may differ between the two sides of a seam of u or v that the box straddles. The clamp
/// can hide a difference only where the other coordinate plays no part.
bool jumps(const StrengthProfile& profile, const UvGradientBound& uv) {
  StrengthProfile ends = profile;
  const bool u_alone = profile.along_v == ProfileFunction::one;
  const bool v_alone = profile.along_u == ProfileFunction::one;
  if (!u_alone && !v_alone) {
    ends.lower = -kInfinity;
    ends.upper = kInfinity;
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
  const auto [u, v] = enclose_uv(primitive, local.box);
  const UvGradientBound slopes = enclose_uv_gradient(primitive, local.box);
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
  for (std::size_t axis = 0; axis < 3; ++axis) {
    b.gradient[axis] = du * slopes.u[axis] + dv * slopes.v[axis];
  }
  return b;
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

std::array<Interval, 3> ball(const Vec3d& center, double radius) {
  return {widened(center.x, radius), widened(center.y, radius), widened(center.z, radius)};
}

/// The transposed linear map applied to a box of gradients.
std::array<Interval, 3> to_world_gradient(const Term& term, const std::array<Interval, 3>& local) {
  if (!term.to_local) return local;
  const Mat3 map = transpose(term.to_local->linear);
  std::array<Interval, 3> world;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& row = map.row[i];
    world[i] = Interval(row.x) * local[0] + Interval(row.y) * local[1] + Interval(row.z) * local[2];
  }
  return world;
}

/// Bounds of |D^2 I| over parts of a ball, tighter than over all of it, for the price of a few:
/// they fall with the distance, so a step function of that will do.
template <class K, class P>
class TurnSteps {
 public:
  /// `at_near` is the bound at reach.near, `span` the diameter of the ball.
  TurnSteps(const K& kernel, const P& primitive, const Reach& reach, double span, double at_near)
      : kernel_(kernel), primitive_(primitive), near_(reach.near), step_(span / kSteps) {
    bounds_.fill(-1.0);
    bounds_[0] = at_near;
  }
  double at(double distance) {
    const double steps = std::clamp((distance - near_) / step_, 0.0, kSteps - 1.0);
    const auto k = static_cast<std::size_t>(steps);
    if (bounds_[k] < 0.0) {
      Reach reach;
      reach.near = near_ + static_cast<double>(k) * step_;
      reach.size = size(primitive_);
      bounds_[k] = near_bound(kernel_, primitive_, 2, reach);
    }
    return bounds_[k];
  }

 private:
  static constexpr int kSteps = 6;
  const K& kernel_;
  const P& primitive_;
  double near_, step_;
  std::array<double, kSteps> bounds_;
};

/// Boxes whose integrals are computed together.
constexpr std::size_t kBatch = 64;
/// A remainder up to this, in units of T, is small beside what a box of use leaves open.
constexpr double kSmallRemainder = 1e-3;

/// Adds weight * I as Taylor polynomials about the centres; `turn` bounds |D^2 I| over the hull.
template <class K, class P>
class TaylorSum {
 public:
  TaylorSum(const Term& term, const K& kernel, const P& primitive, const LocalBox& hull,
            const Reach& reach, const Interval& integral, double turn)
      : term_(term),
        kernel_(kernel),
        primitive_(primitive),
        hull_(hull),
        reach_(reach),
        integral_(integral),
        turn_(turn),
        condition_(condition_number(primitive)),
        least_(rounding_size(kernel, primitive, reach)) {}

  /// `weight`: what is known of the product of the profiles over all boxes.
  void add(const BoxBatch& batch, const Interval& weight, double negligible,
           std::span<SumBound> sums) const {
    const bool constant = weight.width() * integral_.magnitude() <= negligible;
    const double radius = batch.radius * hull_.stretch;
    const bool near = sums.size() > 1 && 0.5 * turn_ * radius * radius > kSmallRemainder;
    TurnSteps<K, P> steps(kernel_, primitive_, reach_, 2 * hull_.radius, turn_);
    std::array<Vec3d, kBatch> local;
    std::array<Jet, kBatch> jets;
    for (std::size_t first = 0; first < sums.size(); first += kBatch) {
      const std::size_t n = std::min(kBatch, sums.size() - first);
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3d& center = batch.centers[first + i];
        local[i] = term_.to_local ? (*term_.to_local)(center) : center;
        jets[i] = Jet{};
      }
      add_integrals(term_, kernel_, primitive_, 1.0, {local.data(), n}, std::span(jets.data(), n));
      for (std::size_t i = 0; i < n; ++i) {
        const Interval own = constant ? weight : weight_at(batch.boxes[first + i]);
        const double turn =
            near ? steps.at(nearest(term_, primitive_, local[i]) - radius - slack(radius)) : turn_;
        add_one(jets[i], own, turn, sums[first + i]);
      }
    }
  }

 private:
  Interval weight_at(const Aabb& box) const {
    return weight_range(term_, primitive_, local_box(term_, box).box);
  }
  /// As in reach(): of a distance in these coordinates.
  double slack(double radius) const { return 16 * kEpsilon * (reach_.scale + radius); }

  void add_one(const Jet& jet, const Interval& weight, double turn, SumBound& sum) const {
    const double middle = 0.5 * (weight.lo + weight.hi);
    const double factor = std::abs(middle);
    const Vec3d& g = jet.gradient;
    const double slope = std::abs(g.x) + std::abs(g.y) + std::abs(g.z);
    sum.center += (term_.sign * middle) * Jet{jet.value, to_world_gradient(term_, g)};
    sum.hessian += factor * turn * hull_.stretch * hull_.stretch;
    sum.deviation += (0.5 * weight.width() + 4 * kEpsilon * factor) * integral_.magnitude();
    sum.rounding += factor * kBackwardError *
                    (condition_ * std::max(std::abs(jet.value), least_.value) +
                     std::max(slope, least_.slope) * reach_.scale);
  }

  const Term& term_;
  const K& kernel_;
  const P& primitive_;
  const LocalBox& hull_;
  const Reach& reach_;
  const Interval& integral_;
  double turn_, condition_;
  RoundingSize least_;
};

/// add_bounds() for one pair.
template <class K, class P>
void add_pair(const Term& term, const K& kernel, const P& primitive, const BoxBatch& batch,
              double negligible, std::span<SumBound> sums) {
  const LocalBox hull = local_box(term, batch.hull);
  const Reach r = reach(term, primitive, hull);
  const Interval integral = integral_range(kernel, primitive, r);
  Interval weight(1.0);
  if (!term.profiles.empty()) weight = weight_range(term, primitive, hull.box);
  const Interval range = Interval(term.sign) * weight * integral;
  if (range.width() <= negligible) {
    for (SumBound& sum : sums) sum.range = sum.range + range;
    return;
  }
  const double turn = near_bound(kernel, primitive, 2, r);
  const double radius = batch.radius * hull.stretch;
  if (turn * radius * radius < integral.width()) {
    TaylorSum<K, P>(term, kernel, primitive, hull, r, integral, turn)
        .add(batch, weight, negligible, sums);
  } else if (sums.size() == 1) {
    sums[0].range = sums[0].range + range;
  } else {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      add_pair(term, kernel, primitive, BoxBatch(batch.boxes.subspan(i, 1)), negligible,
               sums.subspan(i, 1));
    }
  }
}

}  // namespace

BoxBatch::BoxBatch(std::span<const Aabb> boxes_) : boxes(boxes_) {
  centers.reserve(boxes.size());
  for (const Aabb& box : boxes) {
    centers.push_back(box.center());
    radius = std::max(radius, half_diagonal(box));
    hull.include(box);
  }
}

void add_bounds(const Term& term, const BoxBatch& batch, double negligible,
                std::span<SumBound> sums) {
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    add_pair(term, kernel, primitive, batch, negligible, sums);
  });
}

Interval range_of(const SumBound& sum, std::size_t terms, const Aabb& box) {
  const Vec3d half = 0.5 * box.extent();
  const Vec3d& g = sum.center.gradient;
  const double slope = std::abs(g.x) * half.x + std::abs(g.y) * half.y + std::abs(g.z) * half.z;
  // n terms add up to within n / 2 ulp of their magnitudes, in either order.
  const double rounding = sum.rounding * (1 + static_cast<double>(terms) / 32);
  const double bend = 0.5 * sum.hessian * (0.25 * squared_norm(box.extent()));
  const double deviation = (slope + bend + sum.deviation + rounding) * (1 + 1e-12);
  return widened(sum.range + Interval(sum.center.value), deviation);
}

std::array<Interval, 3> gradient_bound(const Term& term, const Aabb& box) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Reach r = reach(term, primitive, local);
    const double slope = near_bound(kernel, primitive, 1, r);
    const double turn = near_bound(kernel, primitive, 2, r) * local.radius;
    std::array<Interval, 3> gradient = ball({}, slope);
    if (turn < slope) {
      const Jet center = integral_of(term, kernel, primitive, local.center);
      const std::array<Interval, 3> near = ball(center.gradient, turn);
      for (std::size_t i = 0; i < 3; ++i) gradient[i] = intersection(gradient[i], near[i]);
    }
    if (!term.profiles.empty()) {
      const Interval field = integral_range(kernel, primitive, r);
      const WeightBound weight = weight_bound(term, primitive, local);
      for (std::size_t i = 0; i < 3; ++i) {
        gradient[i] = weight.w * gradient[i] + field * weight.gradient[i];
      }
    }
    for (Interval& component : gradient) component = Interval(term.sign) * component;
    return to_world_gradient(term, gradient);
  });
}

double hessian_bound(const Term& term, const Aabb& box) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    double factor = local.stretch * local.stretch;
    if (!term.profiles.empty()) {
      const std::optional<Interval> flat = flat_weight(term, primitive, local);
      if (!flat) return kInfinity;
      factor *= flat->magnitude();
    }
    return factor * near_bound(kernel, primitive, 2, reach(term, primitive, local));
  });
}

}  // namespace cs2mesh
