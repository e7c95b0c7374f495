// A triangle of a far field as a few chords, each of them summed like any other segment.
//
// With c the vertex opposite to the shortest edge, l the longest edge, and s a lower bound of
// |p - q|^2 + tau for all q of the triangle, the mean G over a chord at u (chord_rule.h) has
//     |G^(m)| / m! <= binomial(m + 2 nu - 1, m) l^m s^(-nu - m/2),
// as each of its points moves along a straight line from c by no more than l. So n chords leave
// open
//     |error| <= mass 2 h_n binomial(2n + 2 nu - 1, 2n) (l^2 / s)^n s^-nu,
// 2 h_n = n!^2 (n + 1)!^2 / ((n + 1) (2n + 1)!^2) the norm of the monic polynomial of the nodes
// for the weight 2u, and what is left out of the chords themselves comes on top
// (integral/far_nodes.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libfield/field/source_tree.h"
#include "libfield/integral/chord_rule.h"
#include "libfield/integral/segment_sum.h"

namespace cs2mesh {

/// The error of n chords at squared distance s, relative to mass s^-nu (l^2 / s)^n; rounded up.
double chord_factor(double two_nu, int n);

/// One chord of a triangle.
struct FarChord {
  std::uint32_t element = 0;  ///< by its place in a source tree
  std::uint16_t rule = 0;     ///< an entry of kChordCounts
  std::uint16_t number = 0;   ///< in that rule
};

/// The chord as a segment with its part of the weight.
SegmentSource chord_source(const FarElement& triangle, const Chord& chord);

/// Chords as segments to be summed, made where they are used: they would be ten times the memory of
/// their triangles.
class ChordSources {
 public:
  void set(std::span<const FarChord> chords, std::span<const FarElement> elements);
  const std::vector<SegmentSource>& sources() const { return sources_; }
  /// The places of all of them.
  std::span<const std::uint32_t> all() const { return std::span(places_).first(sources_.size()); }

 private:
  std::vector<SegmentSource> sources_;
  std::vector<std::uint32_t> places_;  ///< 0, 1, 2, ... as long as was ever needed
};

}  // namespace cs2mesh
