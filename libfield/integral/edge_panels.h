// Integrals along an edge of functions that are even in the abscissa t from the foot of p, whose
// singularities stand at t = +-i gap: Gauss-Legendre panels of 14 nodes that grow with the distance
// from the foot, each lane's by itself, so that all lanes advance together.
//
// A panel [t, t + L] whose ends' distances to such a pole add up to `reach` lengths (see
// gauss_legendre.h) has, with r = sqrt(gap^2 + t^2),
//     L = 2 (t + reach r) / (reach^2 - 1),
// at either side of the foot. At reach 2.2 the far end's t is 2.7 times the near one's: a panel for
// each factor of 2.7 between the gap and the edge's far end.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/integral/gauss_legendre.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh::detail {

/// The part of an edge from one abscissa to another. Its length is given, as the abscissae carry
/// the rounding of wherever they were computed from.
template <class T>
struct Stretch {
  T from, to, length;
};

/// L above.
template <class T>
T longest_panel(const T& reach, const T& t, const T& squared_gap) {
  using std::sqrt;
  return T(2) * (t + reach * sqrt(squared_gap + t * t)) / (reach * reach - T(1));
}

/// Calls take(t, t', weight) at pairs of nodes of panels over the stretch, both of that weight, in
/// the lanes that are set; in the others, and in those that are done, with weight 0 at a finite t.
/// limit(t) is the longest panel that may begin at t. What lies on both sides of the foot is summed
/// on one. (In pairs two nodes share a division, which is what integrands spend most of their time
/// on.)
template <class T, class Limit, class Take>
void visit_edge_panels(const Stretch<T>& edge, const MaskOf<T>& lanes, const Limit& limit,
                       const Take& take) {
  using std::abs;
  using std::max;
  using std::min;
  constexpr const UnitRule<14>& rule = kUnitRule<14>;
  // From a gap of 1e-13 of the edge on, some 32 do.
  constexpr int kMostPanels = 64;
  const T near = min(abs(edge.from), abs(edge.to)), far = max(abs(edge.from), abs(edge.to));
  const MaskOf<T> across = both(edge.from < T(0), T(0) < edge.to);
  const MaskOf<T> single = across & (edge.length <= limit(edge.from));
  const MaskOf<T> folded = across & MaskOf<T>(!single);
  const T scale = edge.length / select(folded, T(near + far), T(1));
  T t = select(single, edge.from, select(folded, T(0), near));
  T twice = select(MaskOf<T>(lanes & folded), T(near * scale), T(0));
  T once = select(lanes, select(folded, T((far - near) * scale), edge.length), T(0));
  for (int i = 0; i < kMostPanels && any(MaskOf<T>((twice > T(0)) | (once > T(0)))); ++i) {
    const MaskOf<T> doubled = twice > T(0);
    const T step = min(select(doubled, twice, once), limit(t));
    const T weight = select(doubled, T(T(2) * step), step);
    for (std::size_t j = 0; j < 7; ++j) {
      take(T(t + T(rule.node[j]) * step), T(t + T(rule.node[13 - j]) * step),
           T(T(rule.weight[j]) * weight));
    }
    t += step;
    twice = select(doubled, T(twice - step), twice);
    once = select(doubled, once, T(once - step));
  }
}

}  // namespace cs2mesh::detail
