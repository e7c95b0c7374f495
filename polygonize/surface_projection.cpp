#include "polygonize/surface_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "polygonize/edge_root.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Overshoot of the Newton step, so that F changes its sign before the end of it where F is nearly
/// linear.
constexpr double kOvershoot = 1.05;

bool inside(double value) {
  return value >= 0;
}

/// A way from a point to a place where F has the other sign.
struct Way {
  std::size_t point = 0;
  Vec3d direction;        ///< unit
  double t0 = 0, t1 = 0;  ///< F changes its sign between; jets at both ends
  Jet at_t0, at_t1;
};

class Projector {
 public:
  Projector(const ImplicitSurface& surface, const ImplicitSurface& local, const Aabb& box,
            std::span<const Vec3d> points, double limit, std::span<Projection> out)
      : surface_(surface), local_(local), box_(box), points_(points), limit_(limit), out_(out) {}

  void run() {
    step();
    for (const std::size_t i : lost_) {
      if (!search_line(i) && !follow_gradient(i)) search_spheres(i);
    }
    refine();
    for (const std::size_t i : bent_) tighten(i);
  }

 private:
  Vec3d at(const Way& way, double t) const { return points_[way.point] + t * way.direction; }

  /// The least step that gets past the surface for certain where a point is on it but for the
  /// rounding of its coordinates and of F.
  double grain(std::size_t i) const {
    const Vec3d& p = points_[i];
    return 1e-14 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
  }

  // ---- One Newton step for all points together ----

  void step() {
    jets_.resize(points_.size());
    local_.jets(points_, jets_);
    std::vector<Way> ways;
    std::vector<Vec3d> ends;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Jet& jet = jets_[i];
      const double slope = norm(jet.gradient);
      const double length = std::abs(jet.value) / slope;
      if (jet.value == 0) {
        out_[i] = {0, points_[i], jet.gradient};
      } else if (!(slope > 0 && slope < kInfinity && length < limit_)) {
        lost_.push_back(i);
      } else {
        const Vec3d direction = jet.gradient * ((inside(jet.value) ? -1 : 1) / slope);
        ways.push_back({i, direction, 0, kOvershoot * length + grain(i), jet, {}});
        ends.push_back(at(ways.back(), ways.back().t1));
      }
    }
    std::vector<Jet> end_jets(ends.size());
    evaluate(ends, end_jets);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      ways[k].at_t1 = end_jets[k];
      settle_or_keep(ways[k]);
    }
  }

  /// Jets from the cheap restriction wherever it holds.
  void evaluate(std::span<const Vec3d> at, std::span<Jet> out) const {
    std::vector<Vec3d> near, far;
    for (const Vec3d& p : at) (box_.contains(p) ? near : far).push_back(p);
    std::vector<Jet> near_jets(near.size()), far_jets(far.size());
    local_.jets(near, near_jets);
    if (!far.empty()) surface_.jets(far, far_jets);
    std::size_t n = 0, f = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      out[k] = box_.contains(at[k]) ? near_jets[n++] : far_jets[f++];
    }
  }

  void settle_or_keep(const Way& way) {
    if (inside(way.at_t0.value) == inside(way.at_t1.value)) {
      lost_.push_back(way.point);
      return;
    }
    const double slope0 = dot(way.at_t0.gradient, way.direction);
    const double slope1 = dot(way.at_t1.gradient, way.direction);
    // With slopes this alike the cubic through both jets is far more exact than the distance needs.
    if (!(slope1 * slope0 > 0 && slope1 / slope0 > 0.8 && slope1 / slope0 < 1.25)) {
      curved_.push_back(way);
      return;
    }
    const double length = way.t1 - way.t0;
    const double root =
        hermite_root(way.at_t0.value, slope0 * length, way.at_t1.value, slope1 * length);
    settle(way, way.t0 + root * length, way.at_t1.gradient);
  }

  void settle(const Way& way, double t, const Vec3d& gradient) {
    settle_at(way.point, t, at(way, t), gradient);
  }

  void settle_at(std::size_t i, double distance, const Vec3d& foot, const Vec3d& gradient) {
    out_[i] = {distance, foot, gradient};
    // The nearest foot is the one from which the point lies along the normal; 0.98 is 11 degrees
    // off, which can make the distance 2 % too long where the surface is flat.
    const double slope = norm(gradient);
    const double aligned = std::abs(dot(points_[i] - foot, gradient));
    if (slope > 0 && aligned < 0.98 * slope * distance) bent_.push_back(i);
  }

  // ---- Points for which that was not enough ----

  bool search_line(std::size_t i) {
    const Jet& jet = jets_[i];
    const double slope = norm(jet.gradient);
    if (!(slope > 0 && slope < kInfinity)) return false;
    const Vec3d direction = jet.gradient * ((inside(jet.value) ? -1 : 1) / slope);
    // Fractions of the step, for where it went beyond a thin place, then multiples.
    constexpr int kSmaller = 12, kLarger = 6;
    const double step = std::min(kOvershoot * std::abs(jet.value) / slope + grain(i), limit_);
    std::array<Vec3d, kSmaller + kLarger + 1> places;
    std::array<double, kSmaller + kLarger + 1> lengths, values;
    for (int k = 0; k <= kSmaller + kLarger; ++k) {
      const auto n = static_cast<std::size_t>(k);
      lengths[n] = std::min(std::ldexp(step, k - kSmaller), limit_);
      places[n] = points_[i] + lengths[n] * direction;
    }
    surface_.values(places, values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (inside(values[k]) != inside(jet.value)) {
        return add_bracket(i, direction, k == 0 ? 0 : lengths[k - 1], lengths[k]);
      }
    }
    return false;
  }

  /// Climbs (or descends) F in short steps until its sign changes.
  bool follow_gradient(std::size_t i) {
    constexpr int kSteps = 80;
    const bool side = inside(jets_[i].value);
    Vec3d p = points_[i];
    Jet jet = jets_[i];
    double longest = limit_ / 16;
    for (int step = 0; step < kSteps; ++step) {
      const double slope = norm(jet.gradient);
      if (!(slope > 0 && slope < kInfinity)) return false;
      const double length = std::min(kOvershoot * std::abs(jet.value) / slope + grain(i), longest);
      const Vec3d next = p + ((side ? -1 : 1) * length / slope) * jet.gradient;
      const Jet there = surface_.jet(next);
      if (inside(there.value) != side) {
        const CrossedEdge edge{p, next, jet, there};
        Vec3d root;
        EdgeRootCounts counts;
        find_roots(surface_, {&edge, 1}, {&root, 1}, counts);
        settle_at(i, norm(root - points_[i]), root, surface_.jet(root).gradient);
        return true;
      }
      if (std::abs(there.value) < std::abs(jet.value)) {
        p = next;
        jet = there;
      } else {
        longest = length / 2;  // that was over the top
      }
    }
    return false;
  }

  void search_spheres(std::size_t i) {
    constexpr std::size_t kDirections = 48;
    std::array<Vec3d, kDirections> places;
    std::array<double, kDirections> values;
    const bool side = inside(jets_[i].value);
    constexpr double kSmallest = 0x1p-30;
    bool first = true;
    for (double radius = limit_ * kSmallest; radius <= limit_; radius *= 2) {
      for (std::size_t k = 0; k < kDirections; ++k) {
        places[k] = points_[i] + radius * spiral_direction(k, kDirections);
      }
      surface_.values(places, values);
      for (std::size_t k = 0; k < kDirections; ++k) {
        if (inside(values[k]) != side) {
          // Half as far out there was no change in any direction, except for the first sphere.
          add_bracket(i, spiral_direction(k, kDirections), first ? 0 : radius / 2, radius);
          return;
        }
      }
      first = false;
    }
  }

  /// Directions spread evenly over the sphere, turning by the golden angle from pole to pole.
  static Vec3d spiral_direction(std::size_t k, std::size_t count) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double angle = static_cast<double>(k) * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  bool add_bracket(std::size_t i, const Vec3d& direction, double t0, double t1) {
    Way way{i, direction, t0, t1, {}, {}};
    const std::array<Vec3d, 2> ends = {at(way, t0), at(way, t1)};
    std::array<Jet, 2> jets;
    surface_.jets(ends, jets);
    way.at_t0 = jets[0];
    way.at_t1 = jets[1];
    if (inside(jets[0].value) == inside(jets[1].value)) return false;  // values() rounds otherwise
    curved_.push_back(way);
    return true;
  }

  // ---- Exact roots where F is not nearly linear ----

  void refine() {
    if (curved_.empty()) return;
    std::vector<CrossedEdge> edges;
    for (const Way& way : curved_) {
      edges.push_back({at(way, way.t0), at(way, way.t1), way.at_t0, way.at_t1});
    }
    std::vector<Vec3d> roots(edges.size());
    std::vector<Jet> jets(edges.size());
    EdgeRootCounts counts;
    find_roots(surface_, edges, roots, counts);
    surface_.jets(roots, jets);
    for (std::size_t k = 0; k < roots.size(); ++k) {
      settle(curved_[k], norm(roots[k] - points_[curved_[k].point]), jets[k].gradient);
    }
  }

  /// Slides the foot along the surface towards the point, as long as that makes it nearer.
  void tighten(std::size_t i) {
    constexpr int kSlides = 24, kHalvings = 8;
    constexpr double kSquareEnough = 1e-3;
    for (int slide = 0; slide < kSlides; ++slide) {
      const Vec3d to_point = points_[i] - out_[i].foot;
      const Vec3d normal = out_[i].gradient / norm(out_[i].gradient);
      const Vec3d along = to_point - dot(to_point, normal) * normal;
      if (!(norm(along) > kSquareEnough * out_[i].distance)) return;
      bool nearer = false;
      for (int k = 0; k < kHalvings && !nearer; ++k) {
        nearer = try_foot(i, out_[i].foot + std::ldexp(1.0, -k) * along);
      }
      if (!nearer) return;
    }
  }

  /// Moves `guess` onto the surface; true, and the new foot, if that is nearer than the old one.
  bool try_foot(std::size_t i, Vec3d guess) {
    constexpr int kNewtonSteps = 4;
    Jet jet = surface_.jet(guess);
    for (int step = 0; step < kNewtonSteps; ++step) {
      const double slope2 = squared_norm(jet.gradient);
      if (!(slope2 > 0)) return false;
      guess -= (jet.value / slope2) * jet.gradient;
      jet = surface_.jet(guess);
    }
    const double slope = norm(jet.gradient);
    if (!(slope > 0)) return false;
    // A change of sign across the guess proves that there is surface.
    const double doubt = 1e-7 * out_[i].distance;
    const Vec3d across = (doubt / slope) * jet.gradient;
    if (inside(surface_.value(guess - across)) || !inside(surface_.value(guess + across))) {
      return false;
    }
    const double distance = norm(guess - points_[i]) + doubt;
    if (!(distance < (1 - 1e-6) * out_[i].distance)) return false;
    out_[i] = {distance, guess, jet.gradient};
    return true;
  }

  const ImplicitSurface& surface_;
  const ImplicitSurface& local_;
  const Aabb& box_;
  std::span<const Vec3d> points_;
  double limit_;
  std::span<Projection> out_;
  std::vector<Jet> jets_;
  std::vector<std::size_t> lost_;  ///< points whose step did not change the sign
  std::vector<Way> curved_;
  std::vector<std::size_t> bent_;  ///< points whose way does not meet the surface squarely
};

}  // namespace

void project(const ImplicitSurface& surface, const ImplicitSurface& local, const Aabb& box,
             std::span<const Vec3d> points, double search_limit, std::span<Projection> out) {
  for (Projection& projection : out) projection = {};
  Projector(surface, local, box, points, search_limit, out).run();
}

void project(const ImplicitSurface& surface, std::span<const Vec3d> points, double search_limit,
             std::span<Projection> out) {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  // Room for the steps that leave the hull of the points.
  box = box.grown(0.05 * box.diagonal());
  project(surface, *surface.restrict_to(box), box, points, search_limit, out);
}

/// Of the smallest sphere that search_around() looks at and the largest.
constexpr double kSearchSpan = 1.0 / 32;

namespace {

/// The change of sign on the way from p to q, which lie on different sides.
SignChange narrowed(const ImplicitSurface& surface, const Vec3d& p, const Vec3d& q, bool side) {
  constexpr int kHalvings = 8;
  const auto at = [&](double t) { return p + t * (q - p); };
  double lo = 0, hi = 1;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (lo + hi);
    (inside(surface.value(at(middle))) == side ? lo : hi) = middle;
  }
  return SignChange{hi * norm(q - p), at(lo), at(hi)};
}

/// From q on, along the sphere about p, towards the other side: a place there, if F gets that far.
std::optional<Vec3d> climb(const ImplicitSurface& surface, const Vec3d& p, Vec3d q, bool side) {
  constexpr int kMostSteps = 12;
  const double uphill = side ? -1 : 1;
  double turn = 0.4;  // radians
  Jet jet = surface.jet(q);
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3d out = q - p;
    const double radius = norm(out);
    const Vec3d along = uphill * (jet.gradient - dot(jet.gradient, out) / (radius * radius) * out);
    const double length = norm_of_any(along);
    if (!(length > 0)) return std::nullopt;
    const Vec3d turned = out + (turn * radius / length) * along;
    const Vec3d next = p + (radius / norm(turned)) * turned;
    const Jet there = surface.jet(next);
    if (inside(there.value) != side) return next;
    if (uphill * there.value > uphill * jet.value) {
      q = next;
      jet = there;
    } else {
      turn *= 0.5;
    }
  }
  return std::nullopt;
}

}  // namespace

namespace {

/// From a point along the axes and diagonals to a sphere about it.
std::vector<Vec3d> points_on_sphere(const Vec3d& p, double radius) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 27; ++i) {
    const Vec3d d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
    const double length = norm(d);
    if (length > 0) points.push_back(p + (radius / length) * d);
  }
  return points;
}

/// Where F has another sign on a sphere about p than there; 27 values or a few more.
std::optional<SignChange> change_on_sphere(const ImplicitSurface& surface, const Vec3d& p,
                                           double radius) {
  std::vector<Vec3d> points = points_on_sphere(p, radius * (1 - 1e-12));
  points.push_back(p);
  std::vector<double> values(points.size());
  const auto near = surface.restrict_to(Aabb{p, p}.grown(radius));
  near->values(points, values);
  const bool side = inside(values.back());
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (inside(values[i]) != side) return narrowed(*near, p, points[i], side);
  }
  return std::nullopt;
}

}  // namespace

std::optional<SignChange> search_around(const ImplicitSurface& surface, const Vec3d& p,
                                        double farthest, bool closely) {
  constexpr int kSpheres = 11, kCloseSpheres = 13;
  constexpr int kFirstHalf = 8;  // the sphere of half the size; closely, more follow
  constexpr double kQuarterOctave = 1.189207115002721;
  const auto near = surface.restrict_to(Aabb{p, p}.grown(farthest * (1 + 1e-9)));
  const bool side = inside(near->value(p));
  std::vector<double> values;
  double radius = kSearchSpan * farthest;
  for (int sphere = 0; sphere < (closely ? kCloseSpheres : kSpheres); ++sphere) {
    if (sphere > 0) radius *= closely && sphere > kFirstHalf ? kQuarterOctave : std::numbers::sqrt2;
    const std::vector<Vec3d> points = points_on_sphere(p, radius);
    values.resize(points.size());
    near->values(points, values);
    std::optional<SignChange> nearest;
    const auto take = [&](const Vec3d& q) {
      const SignChange found = narrowed(*near, p, q, side);
      if (!nearest || found.distance < nearest->distance) nearest = found;
    };
    for (std::size_t i = 0; i < points.size() && (closely || !nearest); ++i) {
      if (inside(values[i]) != side) take(points[i]);
    }
    if (closely && !nearest) {
      const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
      const auto first = (side ? lowest : highest) - values.begin();
      const auto found = climb(*near, p, points[static_cast<std::size_t>(first)], side);
      if (found) take(*found);
    }
    if (nearest) return nearest;
  }
  return std::nullopt;
}

namespace {

/// How far the surface may be from a point, in first-order distances.
constexpr double kFarthest = 4.0;

/// A point of the surface near `p` by Newton's method along the gradient in the logarithm of the
/// field, which is nearer to linear, if that converges within a few times `first`.
std::optional<Vec3d> newton_foot(const ImplicitSurface& surface, const Vec3d& p, double first) {
  constexpr int kMostSteps = 20;
  constexpr double kConverged = 1e-3;  // of the distance
  const Aabb box = Aabb{p, p}.grown(kFarthest * first);
  const auto near = surface.restrict_to(box);
  Vec3d q = p;
  for (int i = 0; i < kMostSteps; ++i) {
    const Jet jet = near->jet(q);
    const double slope = norm_of_any(jet.gradient);
    if (!(slope > 0)) return std::nullopt;
    const Vec3d step = (-leveled(jet.value) / slope) * (jet.gradient / slope);
    q += step;
    const double distance = norm(q - p);
    if (!(distance <= kFarthest * first) || !box.contains(q)) return std::nullopt;
    // Where hardly any of the field is left its logarithm makes short steps, too.
    if (first_order_distance(jet, HUGE_VAL) <= kConverged * distance) return q;
  }
  return std::nullopt;
}

/// Where F changes its sign on that stretch, on the far side.
Vec3d between(const ImplicitSurface& surface, SignChange change) {
  constexpr int kHalvings = 32;
  const bool side = inside(surface.value(change.near));
  for (int i = 0; i < kHalvings; ++i) {
    const Vec3d middle = 0.5 * (change.near + change.far);
    (inside(surface.value(middle)) == side ? change.near : change.far) = middle;
  }
  return change.far;
}

}  // namespace

Foot find_foot(const ImplicitSurface& surface, const Vec3d& p, double first_order, double enough) {
  const std::optional<Vec3d> straight = newton_foot(surface, p, first_order);
  if (straight && norm(*straight - p) <= enough) return {*straight, norm(*straight - p)};
  // Beside walls and kinks there mostly is surface near by that value and gradient know nothing of.
  if (enough > 0) {
    const std::optional<SignChange> near = change_on_sphere(surface, p, enough);
    if (near) return {near->far, near->distance};
  }
  if (straight) {
    const double distance = norm(*straight - p);
    const std::optional<SignChange> nearer = search_around(surface, p, distance);
    if (!nearer) return {*straight, distance};
    const Vec3d foot = between(surface, *nearer);
    return {foot, norm(foot - p)};
  }
  // Value and gradient may say far too much, as where hardly any of the field is left, or too
  // little, as within a groove of stiff blobs, where they tell of a sphere within the other.
  for (const double share : {kSearchSpan * kSearchSpan, kSearchSpan, 1.0, kFarthest}) {
    const std::optional<SignChange> found = search_around(surface, p, share * first_order);
    if (found) {
      const Vec3d foot = between(surface, *found);
      return {foot, norm(foot - p)};
    }
  }
  return {p, first_order};
}

}  // namespace cs2mesh
