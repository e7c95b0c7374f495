#include "libfield/field/term.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "libfield/integral/bound.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/integral.h"
#include "libfield/primitive/uv_gradient.h"
#include "libfield/profile/profile_slopes.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// The closed forms and rules are tested to 64 ulp of backward error.
constexpr double kBackwardError = 64 * kEpsilon;

/// Calls f(kernel, primitive) with the alternatives held, but for the pairs that diverge, which
/// compile() never lets through.
template <class F>
auto visit_pair(const Term& term, F&& f) {
  return std::visit(
      [&f](const auto& kernel, const auto& primitive) {
        using K = std::decay_t<decltype(kernel)>;
        using P = std::decay_t<decltype(primitive)>;
        constexpr bool kDiverges =
            std::is_same_v<P, Plane> && (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>);
        if constexpr (kDiverges) {
          require(false, "an inverse kernel diverges on a plane");
          return f(Cauchy{1.0}, primitive);
        } else {
          return f(kernel, primitive);
        }
      },
      term.kernel, term.primitive);
}

template <class P>
struct FrameTypeOf {
  using type = P;
};
template <>
struct FrameTypeOf<Segment> {
  using type = SegmentFrame<double>;
};
template <>
struct FrameTypeOf<Arc> {
  using type = ArcFrame<double>;
};
template <>
struct FrameTypeOf<Triangle> {
  using type = TriangleFrame<double>;
};

/// The integral at a point, from the frame where the pair has a closed form that uses it.
template <class K, class P>
Jet integral_of(const Term& term, const K& kernel, const P& primitive, const Vec3d& local) {
  const auto& frame = std::get<typename FrameTypeOf<P>::type>(term.frame);
  if constexpr (requires { integral(kernel, frame, local); }) {
    return integral(kernel, frame, local);
  } else {
    return integral(kernel, primitive, local);
  }
}

/// Longest edge over smallest height of a triangle, 1 for the others: how much the rounding of the
/// vertices is magnified.
double condition_number(const Point&) {
  return 1;
}
double condition_number(const Segment&) {
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

LocalBox local_box(const Term& term, const Aabb& box) {
  const double half = 0.5 * box.diagonal() * (1 + 4 * kEpsilon);
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
      return measure(primitive) * kernel.derivative_envelope(order, r.near) * (1 + 1e-12);
    }
  }
  return derivative_bound(kernel, primitive, order, r.near);
}

Vec3d to_world_gradient(const Term& term, const Vec3d& local) {
  return term.to_local ? transpose(term.to_local->linear) * local : local;
}

/// The product of the profiles at (u, v), with its derivatives.
ProfileValue product(const std::vector<StrengthProfile>& profiles, double u, double v) {
  ProfileValue all;
  for (const StrengthProfile& profile : profiles) {
    const ProfileValue one = evaluate(profile, u, v);
    all = {all.w * one.w, all.du * one.w + all.w * one.du, all.dv * one.w + all.w * one.dv};
  }
  return all;
}

Interval product(const std::vector<StrengthProfile>& profiles, const Interval& u,
                 const Interval& v) {
  Interval all(1.0);
  for (const StrengthProfile& profile : profiles) all = all * enclose(profile, u, v);
  return all;
}

/// sup |w|, wherever the point is.
double largest_weight(const Term& term) {
  if (term.profiles.empty()) return 1.0;
  const bool plane = std::holds_alternative<Plane>(term.primitive);
  const Interval range = plane ? Interval::everything() : Interval(0.0, 1.0);
  return product(term.profiles, range, range).magnitude();
}

/// The integral alone over a ball.
template <class K, class P>
ValueBound integral_bound(const Term& term, const K& kernel, const P& primitive,
                          const LocalBox& local, const Reach& r, double negligible = 0.0) {
  ValueBound b;
  const double highest = near_bound(kernel, primitive, 0, r);
  // Every element of the primitive is nearer than r.far, and h decreases.
  const double mass = measure(primitive);
  const double lowest =
      std::isfinite(mass) ? mass * kernel.profile(r.far * r.far) * (1 - 1e-12) : 0.0;
  b.range = {std::min(lowest, highest), highest};
  if (b.range.width() <= negligible) return b;
  b.hessian = near_bound(kernel, primitive, 2, r);
  b.taylor = b.hessian * local.radius * local.radius < b.range.width();
  if (b.taylor) {
    b.center = integral_of(term, kernel, primitive, local.center);
    b.rounding = kBackwardError * (condition_number(primitive) * std::abs(b.center.value) +
                                   norm(b.center.gradient) * r.scale);
  }
  return b;
}

/// Contains the integral over the ball.
Interval integral_range(const ValueBound& b, double radius) {
  if (!b.taylor) return b.range;
  const double deviation =
      (norm(b.center.gradient) + 0.5 * b.hessian * radius) * radius + b.rounding;
  return intersection(b.range, widened(Interval(b.center.value), deviation));
}

template <class P>
Interval weight_range(const Term& term, const P& primitive, const LocalBox& local) {
  const auto [u, v] = enclose_uv(primitive, local.box);
  return product(term.profiles, u, v);
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
  b.w = product(term.profiles, u, v);
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

/// Adds sign * integral at each point.
template <class K, class P>
void add_integrals(const Term& term, const K& kernel, const P& primitive, double sign,
                   std::span<const Vec3d> points, std::span<Jet> sums) {
  using F = typename FrameTypeOf<P>::type;
  if constexpr (kHasBulk<K, F>) {
    if (points.size() >= kBulkCount) {
      const auto add = std::get<AddIntegrals<K, F>>(bulk_table());
      add(kernel, std::get<F>(term.frame), sign, points.data(), sums.data(), points.size());
      return;
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    sums[i] += sign * integral_of(term, kernel, primitive, points[i]);
  }
}

/// The product of the profiles with an integral.
template <class P>
Jet weighted(const Term& term, const P& primitive, const Vec3d& local, const Jet& field) {
  if (term.profiles.empty()) return field;
  const Uv at = uv(primitive, local);
  const ProfileValue weight = product(term.profiles, at.u, at.v);
  return {
      weight.w * field.value,
      weight.w * field.gradient + field.value * (weight.du * at.grad_u + weight.dv * at.grad_v)};
}

}  // namespace

Frame frame_of(const Primitive& primitive) {
  return std::visit(
      [](const auto& p) -> Frame {
        using P = std::decay_t<decltype(p)>;
        return typename FrameTypeOf<P>::type(p);
      },
      primitive);
}

void accumulate(const Term& term, std::span<const Vec3d> points, std::span<Jet> sums) {
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    if (!term.to_local && term.profiles.empty()) {
      add_integrals(term, kernel, primitive, term.sign, points, sums);
      return;
    }
    constexpr std::size_t kRun = 64;
    std::array<Vec3d, kRun> local;
    std::array<Jet, kRun> fields;
    for (std::size_t first = 0; first < points.size(); first += kRun) {
      const std::size_t n = std::min(kRun, points.size() - first);
      for (std::size_t i = 0; i < n; ++i) {
        local[i] = term.to_local ? (*term.to_local)(points[first + i]) : points[first + i];
        fields[i] = Jet{};
      }
      add_integrals(term, kernel, primitive, 1.0, {local.data(), n}, {fields.data(), n});
      for (std::size_t i = 0; i < n; ++i) {
        Jet jet = weighted(term, primitive, local[i], fields[i]);
        jet.gradient = to_world_gradient(term, jet.gradient);
        sums[first + i] += term.sign * jet;
      }
    }
  });
}

ValueBound value_bound(const Term& term, const Aabb& box, double negligible) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Reach r = reach(term, primitive, local);
    ValueBound b = integral_bound(term, kernel, primitive, local, r, negligible);
    const Interval sign(term.sign);
    double factor = term.sign;
    if (!term.profiles.empty()) {
      const std::optional<Interval> flat =
          b.taylor ? flat_weight(term, primitive, local) : std::nullopt;
      if (!flat) {
        // A profile has corners: its product with the integral is bounded as a product of ranges.
        b.range = sign * weight_range(term, primitive, local) * integral_range(b, local.radius);
        b.taylor = false;
        return b;
      }
      factor *= 0.5 * (flat->lo + flat->hi);
      b.hessian *= flat->magnitude();
      b.rounding = b.rounding * flat->magnitude() + flat->width() * b.range.magnitude();
      b.range = *flat * b.range;
    }
    b.range = sign * b.range;
    b.center = factor * Jet{b.center.value, to_world_gradient(term, b.center.gradient)};
    b.hessian *= local.stretch * local.stretch;
    return b;
  });
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
      const Interval field =
          integral_range(integral_bound(term, kernel, primitive, local, r), local.radius);
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

double magnitude_bound(const Term& term, double distance) {
  const double shrink = term.to_local ? 1 / stretch_bound(inverse(*term.to_local).linear) : 1.0;
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    return largest_weight(term) * derivative_bound(kernel, primitive, 0, distance * shrink);
  });
}

double influence_distance(const Term& term, double epsilon) {
  const double support =
      std::visit([](const auto& kernel) { return kernel.support(); }, term.kernel);
  const double stretch = term.to_local ? stretch_bound(inverse(*term.to_local).linear) : 1.0;
  if (std::isfinite(support)) return support * stretch * (1 + 4 * kEpsilon);

  // Bracket by doubling, then bisect on a logarithmic scale; the outer end is always safe.
  double outer = 1e-300;
  for (double d = 1e-12; d < 1e150; d *= 16) {
    outer = d;
    if (magnitude_bound(term, d) <= epsilon) break;
  }
  if (!(magnitude_bound(term, outer) <= epsilon)) return kInfinity;
  double inner = outer / 16;
  for (int i = 0; i < 8; ++i) {
    const double middle = std::sqrt(inner * outer);
    (magnitude_bound(term, middle) <= epsilon ? outer : inner) = middle;
  }
  return outer;
}

Aabb skeleton_box(const Term& term) {
  const Aabb local =
      std::visit([](const auto& primitive) { return bounds(primitive); }, term.primitive);
  if (!term.to_local || !local.finite()) return local;
  const Affine to_world = inverse(*term.to_local);
  Aabb box;
  for (int corner = 0; corner < 8; ++corner) box.include(to_world(local.corner(corner)));
  return box;
}

}  // namespace cs2mesh
