// Panels for Gauss-Legendre quadrature of functions whose singularities are known: an interval is
// halved until each part is far enough from all of them (see gauss_legendre.h), which grades the
// parts geometrically towards the near ones. The work is bounded by the depth.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "libfield/integral/gauss_legendre.h"

namespace cs2mesh {

enum class Panel { skip, take, split };

inline constexpr int kPanelDepth = 60;
inline constexpr int kPanelOrder = 14;

/// A pair of conjugate singularities at `center` +- i `height`.
struct Singularity {
  double center, height;
};

/// How many times its length the distances of a panel's ends to a singularity must add up to for
/// kPanelOrder nodes to reach the tolerance, with a margin of 1e3 for the function's growth.
inline double panel_reach(double relative_tolerance) {
  const double error = std::clamp(relative_tolerance, 1e-14, 1e-2) * 1e-3;
  const double rho = std::pow(error, -0.5 / kPanelOrder);
  return 0.5 * (rho + 1.0 / rho);
}

inline bool clear_of(const Singularity& s, double a, double b, double reach) {
  return std::hypot(a - s.center, s.height) + std::hypot(b - s.center, s.height) >= reach * (b - a);
}

/// Halves [a, a + length] as decide(a, length) says; calls take(a, length) for what remains.
template <class Decide, class Take>
void visit_panels(double a, double length, const Decide& decide, const Take& take,
                  int depth = kPanelDepth) {
  const Panel verdict = depth > 0 ? decide(a, length) : Panel::take;
  if (verdict == Panel::take) take(a, length);
  if (verdict != Panel::split) return;
  const double half = 0.5 * length;
  visit_panels(a, half, decide, take, depth - 1);
  visit_panels(a + half, length - half, decide, take, depth - 1);
}

/// Cuts [0, length] at the given places, in any order; those outside (0, length) do not matter.
template <std::size_t N, class Visit>
void visit_between(double length, std::array<double, N> cuts, const Visit& visit) {
  std::sort(cuts.begin(), cuts.end());
  double from = 0.0;
  for (const double cut : cuts) {
    if (!(cut > from && cut < length)) continue;
    visit(from, cut - from);
    from = cut;
  }
  if (from == 0.0) {
    visit(0.0, length);
  } else {
    visit(from, length - from);
  }
}

/// A part of an interval on one side of the origin: x = sign * (start + o), 0 <= o <= length.
struct Piece {
  double start, length, sign;
};

/// [x1, x2], of that length, as pieces that begin at their point nearest to 0, so that offsets keep
/// all digits there: one piece, or two with 0 between them. Their lengths add up to `length`, while
/// x1 and x2 carry the rounding of wherever they were computed from.
struct Pieces {
  std::array<Piece, 2> piece;
  std::size_t count;
};
inline Pieces pieces_of(double x1, double x2, double length) {
  if (x1 >= 0.0) return {{Piece{x1, length, 1.0}}, 1};
  if (x2 <= 0.0) return {{Piece{-x2, length, -1.0}}, 1};
  const double scale = length / (x2 - x1);
  return {{Piece{0.0, x2 * scale, 1.0}, Piece{0.0, -x1 * scale, -1.0}}, 2};
}

}  // namespace cs2mesh
