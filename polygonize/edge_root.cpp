#include "polygonize/edge_root.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

bool is_inside(double f) {
  return f >= 0;
}

/// The state of one search: t in (lo, hi), F of unlike sign at the two.
struct Search {
  std::size_t edge = 0;
  double lo = 0, hi = 1;
  double t = 0.5;
  double scale = 1;  ///< largest coordinate of the edge, in units of its length
  double last_step = std::numeric_limits<double>::infinity();
  int round = 0;
  bool a_inside = false;
};

double largest_coordinate(const Vec3d& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

Search start(std::size_t edge, const CrossedEdge& e) {
  const Vec3d direction = e.b - e.a;
  const double length = norm(direction);
  Search s;
  s.edge = edge;
  s.a_inside = is_inside(e.at_a.value);
  s.scale = std::max({1.0, largest_coordinate(e.a) / length, largest_coordinate(e.b) / length});
  s.t = hermite_root(e.at_a.value, dot(e.at_a.gradient, direction), e.at_b.value,
                     dot(e.at_b.gradient, direction));
  return s;
}

/// Takes in the jet at s.t; returns whether s.t is the root, else moves it.
bool advance(Search& s, const Jet& jet, const Vec3d& direction) {
  // Coordinates near the root are known to half an ulp: 1.1e-16 of their size.
  constexpr double kBracketResolution = 1e-15;
  constexpr double kStepResolution = 4e-15;
  // Steps below this that no longer shrink are the rounding noise of F.
  constexpr double kNoise = 1e-13;
  const double f = jet.value;
  (is_inside(f) == s.a_inside ? s.lo : s.hi) = s.t;
  const double step = -f / dot(jet.gradient, direction);
  if (f == 0 || s.hi - s.lo <= kBracketResolution * s.scale) return true;
  if (std::abs(step) <= kStepResolution * s.scale) return true;
  if (std::abs(step) <= kNoise * s.scale && std::abs(step) >= 0.5 * s.last_step) return true;
  // One more step of a method that converges quadratically: its error is below the resolution, and
  // even a crease within the step would leave it at 1e-9 of an edge.
  constexpr double kLastStep = 1e-9;
  constexpr double kQuadratic = 1e-3;
  const double newton = s.t + step;
  const bool usable = newton > s.lo && newton < s.hi;
  if (usable && std::abs(step) <= kLastStep && std::abs(step) <= kQuadratic * s.last_step) {
    s.t = newton;
    return true;
  }
  s.last_step = std::abs(step);

  // Newton's method may approach from one side only, so a bracket that hardly shrinks does not tell
  // that it fails; but after a few rounds bisection takes every other one.
  constexpr int kPatience = 4;
  ++s.round;
  const bool bisect = s.round >= kPatience && s.round % 2 == 0;
  s.t = usable && !bisect ? newton : 0.5 * (s.lo + s.hi);
  return false;
}

}  // namespace

double hermite_root(double f0, double d0, double f1, double d1) {
  // p(t) = f0 + t (d0 + t (c2 + t c3))
  const double rise = f1 - f0;
  const double c2 = 3 * rise - 2 * d0 - d1;
  const double c3 = d0 + d1 - 2 * rise;
  double lo = 0;
  double hi = 1;
  double t = f0 / (f0 - f1);
  if (!(t > 0 && t < 1)) t = 0.5;
  if (!std::isfinite(c2) || !std::isfinite(c3)) return t;
  constexpr int kMostSteps = 60;
  constexpr double kEnough = 1e-12;
  for (int i = 0; i < kMostSteps; ++i) {
    const double p = f0 + t * (d0 + t * (c2 + t * c3));
    const double slope = d0 + t * (2 * c2 + t * 3 * c3);
    (is_inside(p) == is_inside(f0) ? lo : hi) = t;
    double next = t - p / slope;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::abs(next - t) <= kEnough) return next;
    t = next;
  }
  return t;
}

void find_roots(const ImplicitSurface& surface, std::span<const CrossedEdge> edges,
                std::span<Vec3d> roots, EdgeRootCounts& counts) {
  require(edges.size() == roots.size(), "find_roots: one root an edge");
  std::vector<Search> open;
  open.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) open.push_back(start(i, edges[i]));

  constexpr int kMostRounds = 200;  // twice what bisection of a double needs
  std::vector<Vec3d> points;
  std::vector<Jet> jets;
  for (int round = 0; !open.empty() && round < kMostRounds; ++round) {
    points.clear();
    for (const Search& s : open) {
      const CrossedEdge& e = edges[s.edge];
      points.push_back(e.a + s.t * (e.b - e.a));
    }
    jets.resize(points.size());
    surface.jets(points, jets);
    counts.jets += points.size();
    ++counts.rounds;

    std::size_t kept = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      Search& s = open[i];
      const CrossedEdge& e = edges[s.edge];
      const bool over = advance(s, jets[i], e.b - e.a) || round + 1 == kMostRounds;
      if (!over) {
        open[kept++] = s;
        continue;
      }
      const double t = std::clamp(s.t, kEndClearance, 1 - kEndClearance);
      if (t != s.t) ++counts.clamped;
      roots[s.edge] = e.a + t * (e.b - e.a);
    }
    open.resize(kept);
  }
}

}  // namespace cs2mesh
