#include "polygonize/surface_projection.h"

#include <array>
#include <cmath>
#include <numbers>

#include "polygonize/edge_root.h"

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
      if (!search_line(i)) search_spheres(i);
    }
    refine();
    for (const Way& way : bent_) tighten(way);
  }

 private:
  Vec3d at(const Way& way, double t) const { return points_[way.point] + t * way.direction; }

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
        // At least some units of rounding of the coordinates, to get past the surface at all.
        const Vec3d& p = points_[i];
        const double grain = 1e-15 * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
        ways.push_back({i, direction, 0, kOvershoot * length + grain, jet, {}});
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
    Projection& out = out_[way.point];
    if (t >= out.distance) return;
    out = {t, at(way, t), gradient};
    // The nearest point lies where the surface is square to the way; 0.95 is 18 degrees off.
    const double slope = norm(gradient);
    if (slope > 0 && std::abs(dot(way.direction, gradient)) < 0.95 * slope) bent_.push_back(way);
  }

  // ---- Points for which that was not enough ----

  bool search_line(std::size_t i) {
    const Jet& jet = jets_[i];
    const double slope = norm(jet.gradient);
    if (!(slope > 0 && slope < kInfinity)) return false;
    const Vec3d direction = jet.gradient * ((inside(jet.value) ? -1 : 1) / slope);
    // Fractions of the step, for where it went beyond a thin place, then multiples.
    constexpr int kSmaller = 12, kLarger = 6;
    const double step = std::min(kOvershoot * std::abs(jet.value) / slope, limit_);
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

  void search_spheres(std::size_t i) {
    constexpr std::size_t kDirections = 48;
    std::array<Vec3d, kDirections> places;
    std::array<double, kDirections> values;
    const bool side = inside(jets_[i].value);
    for (double radius = limit_ * 0x1p-20; radius <= limit_; radius *= 2) {
      for (std::size_t k = 0; k < kDirections; ++k) {
        places[k] = points_[i] + radius * spiral_direction(k, kDirections);
      }
      surface_.values(places, values);
      for (std::size_t k = 0; k < kDirections; ++k) {
        if (inside(values[k]) != side) {
          add_bracket(i, spiral_direction(k, kDirections), radius / 2, radius);
          return;
        }
      }
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

  /// Turns the way towards the normal at its foot as long as that finds surface nearer by.
  void tighten(const Way& first) {
    constexpr int kTurns = 8;
    const std::size_t i = first.point;
    const bool side = inside(jets_[i].value);
    for (int turn = 0; turn < kTurns; ++turn) {
      const Projection known = out_[i];
      const double slope = norm(known.gradient);
      if (!(slope > 0)) return;
      const Vec3d direction = known.gradient * ((side ? -1 : 1) / slope);
      const std::array<Vec3d, 2> ends = {points_[i], points_[i] + known.distance * direction};
      const Jet end = surface_.jet(ends[1]);
      if (inside(end.value) == side) return;
      const CrossedEdge edge{ends[0], ends[1], jets_[i], end};
      Vec3d root;
      EdgeRootCounts counts;
      find_roots(surface_, {&edge, 1}, {&root, 1}, counts);
      const double distance = norm(root - points_[i]);
      if (!(distance < (1 - 1e-3) * known.distance)) return;
      out_[i] = {distance, root, surface_.jet(root).gradient};
    }
  }

  const ImplicitSurface& surface_;
  const ImplicitSurface& local_;
  const Aabb& box_;
  std::span<const Vec3d> points_;
  double limit_;
  std::span<Projection> out_;
  std::vector<Jet> jets_;
  std::vector<std::size_t> lost_;  ///< points whose step did not change the sign
  std::vector<Way> curved_, bent_;
};

}  // namespace

void project(const ImplicitSurface& surface, const ImplicitSurface& local, const Aabb& box,
             std::span<const Vec3d> points, double search_limit, std::span<Projection> out) {
  for (Projection& projection : out) projection = {};
  Projector(surface, local, box, points, search_limit, out).run();
}

}  // namespace cs2mesh
