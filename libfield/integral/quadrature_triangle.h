// Quadrature over a triangle: chords across its height over the longest edge are integrated as
// segments, their integrals along that edge by graded panels.
//
// Legend: the longest edge (the base) lies along x, y points to the apex, z is the height of p over
// the plane; the origin is the foot of p. The chord at x runs from y = yb on the base to the
// slanted side y = ys(x) = yb + h(x), h(x) linear from 0 at a base vertex to the height at the
// apex. The two sides of the apex are done one after the other.
//
// As a function of x a chord's integral is singular where its line passes u = -w^2 (see
// quadrature.h): at x = +-i sqrt(z^2 + w^2) if the chord's y contains 0, and where the ends of the
// chord do: on the slanted side of slope k, with e its distance from the foot, at the foot on that
// side +- i sqrt((z^2 + w^2 + e^2) / (1 + k^2)). Finite supports cut chords from |x| = q on, q^2 =
// R^2 - z^2, with a root singularity there.
#pragma once

#include <limits>

#include "libfield/integral/frames.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/quadrature.h"

namespace cs2mesh {

namespace detail {

/// One side of the apex: chord heights grow from 0 at x = corner by `slope` a unit of |x - corner|.
struct Flank {
  double yb, z;
  double corner, apex;  ///< abscissae
  double length;        ///< |apex - corner|
  double slope;         ///< height / length
  double direction;     ///< +1 if the apex has the greater abscissa

  /// Coefficient of x in ys(x) = yb + slope_x (x - corner).
  double slope_x() const { return direction * slope; }
};

/// The moments of a Gaussian in closed form.
inline void find_moments(const Gaussian& kernel, double c2, double t1, double length,
                         LineMoments& out) {
  const GaussianLine<double> line = gaussian_line(kernel, t1, t1 + length, length, c2);
  out = {line.value, -2.0 * kernel.a * kernel.a * line.value, -line.drop};
}

template <class Moments, class K>
Moments chord_moments(const K& kernel, double c2, double t1, double length, double reach) {
  if constexpr (std::is_same_v<K, Gaussian>) {
    Moments moments;
    find_moments(kernel, c2, t1, length, moments);
    return moments;
  } else {
    return line_moments<Moments>(kernel, c2, t1, t1 + length, length, reach);
  }
}

/// Chooses the panels of one piece of a flank.
template <class K>
class FlankPanels {
 public:
  FlankPanels(const K& kernel, const Flank& flank, const Piece& piece, double plane_gap2,
              double reach)
      : kernel_(kernel), flank_(flank), piece_(piece), plane_gap2_(plane_gap2), reach_(reach) {
    const double k = flank.slope_x();
    const double at_origin = flank.yb - k * flank.corner;  // ys(0)
    const double lo = std::min(flank.yb, at_origin), hi = std::max(flank.yb, at_origin);
    const double gap = std::max({0.0, lo, -hi});
    const double stretch2 = 1.0 + k * k;
    const double z2 = flank.z * flank.z;
    double near2 = z2 + gap * gap;
    double side2 = z2 + at_origin * at_origin / stretch2;
    if constexpr (std::is_same_v<K, Metaball>) {
      // Within a third of the support it is a polynomial.
      const double third2 = kernel.radius * kernel.radius / 9.0;
      near2 = std::max(near2, third2);
      side2 = std::max(side2, third2);
    }
    const double w2 = singular_offset(kernel);
    foot_ = {0.0, std::sqrt(near2 + w2)};
    side_ = {-k * at_origin / stretch2 * piece.sign, std::sqrt((side2 + w2) / stretch2)};
    for (std::size_t i = 0; i < 2; ++i) edge_[i] = half_chord(kinks(kernel)[i], z2);
  }

  Panel operator()(double o, double length) const {
    const double a = piece_.start + o;
    const double b = a + length;
    if constexpr (std::is_same_v<K, Gaussian>) {
      return gaussian(a, length);
    } else {
      if constexpr (!kIsInverse<K> && !std::is_same_v<K, Cauchy>) {
        if (a >= edge_[0]) return Panel::skip;
        for (const double q : edge_) {
          // What a panel this short at the edge gets wrong is below 1e-17 of the whole.
          if (length > 1e-7 * q && !clear_of({q, 0.0}, a, b, reach_)) return Panel::split;
        }
      }
      if constexpr (kIsPolynomial<K>) return Panel::take;
      const bool clear = clear_of(foot_, a, b, reach_) && clear_of(side_, a, b, reach_);
      return clear ? Panel::take : Panel::split;
    }
  }

 private:
  double side_at(double x) const {
    return flank_.yb + flank_.slope_x() * (piece_.sign * x - flank_.corner);
  }

  Panel gaussian(double a, double length) const {
    const double scale = kernel_.a;
    const double a2 = scale * scale;
    if (a2 * (a * a - plane_gap2_) > kGaussianEnd) return Panel::skip;
    if (scale * length > kGaussianSpan) return Panel::split;
    // The exponent at the chord's nearest point, and whether its slanted end is out of sight.
    const double y1 = side_at(a), y2 = side_at(a + length);
    const auto nearest = [&](double ys) {
      return std::max({0.0, std::min(flank_.yb, ys), -std::max(flank_.yb, ys)});
    };
    const double n1 = nearest(y1), n2 = nearest(y2);
    const double change = length * (2.0 * a + length) + std::abs(n2 - n1) * (n2 + n1);
    const double in_sight = std::min(y1 * y1 - n1 * n1, y2 * y2 - n2 * n2);
    const bool side_matters = (y1 > 0.0) != (y2 > 0.0) || a2 * in_sight < kGaussianEnd;
    const double stretch = side_matters ? std::sqrt(1.0 + flank_.slope * flank_.slope) : 1.0;
    const bool smooth = scale * length * stretch <= kGaussianSpan && a2 * change <= kGaussianChange;
    return smooth ? Panel::take : Panel::split;
  }

  const K& kernel_;
  const Flank& flank_;
  const Piece& piece_;
  double plane_gap2_;  ///< squared distance, in the plane, from the foot to the triangle
  double reach_;
  Singularity foot_{}, side_{};
  std::array<double, 2> edge_{};
};

/// int f, int x M, int S, int M of the chords, where f, M, S are their moments.
struct FaceMoments {
  using Chord = LineMoments;
  double f = 0.0, x = 0.0, y = 0.0, z = 0.0;

  /// The chord at abscissa x.
  void add(double weight, const Chord& chord, double at) {
    f += weight * chord.f;
    x += weight * chord.m * at;
    y += weight * chord.s;
    z += weight * chord.m;
  }
  /// Adds a panel whose abscissae were counted in that direction.
  void add_panel(double length, double sign, const FaceMoments& part) {
    f += length * part.f;
    x += length * sign * part.x;
    y += length * part.y;
    z += length * part.z;
  }
};

template <class Face, class K>
void add_flank(const K& kernel, const Flank& flank, double plane_gap2, double reach, Face& sum) {
  if (!(flank.length > 0.0)) return;
  const Pieces pieces = pieces_of(std::min(flank.corner, flank.apex),
                                  std::max(flank.corner, flank.apex), flank.length);
  for (std::size_t i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.piece[i];
    // The distance from the corner is at_start + toward * o.
    const double toward = piece.sign * flank.direction;
    const double at_start = toward > 0.0 ? flank.length - piece.length : piece.length;
    const auto take = [&](double o, double panel) {
      const UnitRule<kPanelOrder>& rule = kUnitRule<kPanelOrder>;
      Face part;
      for (std::size_t j = 0; j < kPanelOrder; ++j) {
        const double offset = o + rule.node[j] * panel;
        const double x = piece.start + offset;
        const double height = flank.slope * std::max(0.0, at_start + toward * offset);
        const double c2 = flank.z * flank.z + x * x;
        part.add(rule.weight[j],
                 chord_moments<typename Face::Chord>(kernel, c2, flank.yb, height, reach), x);
      }
      sum.add_panel(panel, piece.sign, part);
    };
    const FlankPanels<K> decide(kernel, flank, piece, plane_gap2, reach);
    std::array<double, 8> cuts{};
    std::size_t count = 0;
    if (kernel.support() < std::numeric_limits<double>::infinity()) {
      const double k = flank.slope_x() * piece.sign;
      const double at_origin = flank.yb - flank.slope_x() * flank.corner;
      const double stretch2 = 1.0 + k * k;
      for (const double radius : kinks(kernel)) {
        // Where the circle of the support ends, meets the base, meets the slanted side.
        const double q = half_chord(radius, flank.z * flank.z);
        const double chord = half_chord(q, at_origin * at_origin / stretch2) / std::sqrt(stretch2);
        const double middle = -k * at_origin / stretch2;
        for (const double x :
             {q, half_chord(q, flank.yb * flank.yb), middle - chord, middle + chord}) {
          cuts[count++] = x - piece.start;
        }
      }
    }
    visit_between(piece.length, cuts,
                  [&](double o, double panel) { visit_panels(o, panel, decide, take); });
  }
}

/// Where p is as seen from a triangle.
struct FaceView {
  Vec3d along, up, normal;
  double z, height;
  double plane_gap2;  ///< squared distance, in the plane, from the foot to the triangle
  std::array<Flank, 2> flank;

  FaceView(const Triangle& triangle, const Vec3d& p)
      : FaceView(TriangleFrame<double>(triangle), triangle, p) {}

 private:
  FaceView(const TriangleFrame<double>& frame, const Triangle& triangle, const Vec3d& p)
      : along(frame.edge[0].along),
        up(-frame.edge[0].outward),
        normal(frame.normal),
        height(frame.height) {
    const Vec3d to_left = frame.vertex[0] - p;
    const Vec3d to_right = frame.vertex[1] - p;
    const Vec3d to_apex = frame.vertex[2] - p;
    const bool left_nearer = squared_norm(to_left) < squared_norm(to_right);
    const Vec3d& to_base = left_nearer ? to_left : to_right;
    const bool apex_nearest = squared_norm(to_apex) < squared_norm(to_base);
    z = -dot(apex_nearest ? to_apex : to_base, normal);
    const double yb = dot(to_base, up);
    const double x_left = dot(to_left, along);
    const double x_right = dot(to_right, along);
    const double x_apex = dot(to_apex, along);
    const double gap = distance(triangle, p);
    plane_gap2 = std::max(0.0, (gap - std::abs(z)) * (gap + std::abs(z)));
    const double rest = frame.edge[0].length - frame.foot;
    flank = {Flank{yb, z, x_left, x_apex, frame.foot, frame.height / frame.foot, 1.0},
             Flank{yb, z, x_right, x_apex, rest, frame.height / rest, -1.0}};
  }
};

template <class Moments, class K>
Moments moments(const K& kernel, const FaceView& at, double reach) {
  Moments sum;
  if (!(at.height > 0.0)) return sum;
  for (const Flank& flank : at.flank) add_flank(kernel, flank, at.plane_gap2, reach, sum);
  return sum;
}

template <class K>
Jet triangle_quadrature(const K& kernel, const Triangle& triangle, const Vec3d& p, double reach) {
  const FaceView at(triangle, p);
  const auto sum = moments<FaceMoments>(kernel, at, reach);
  return {sum.f, -sum.x * at.along - sum.y * at.up + (at.z * sum.z) * at.normal};
}

}  // namespace detail

template <class K>
Jet quadrature(const K& kernel, const Triangle& triangle, const Vec3d& p,
               double relative_tolerance = 1e-14) {
  if (!(measure(triangle) > 0.0) || detail::vanishes(kernel, triangle, p)) return {};
  const double reach = panel_reach(relative_tolerance);
  return detail::clamped(kernel, triangle, p, [&](const Vec3d& at) {
    return detail::triangle_quadrature(kernel, triangle, at, reach);
  });
}

}  // namespace cs2mesh
