// A triangle as a few chords parallel to one of its edges, the base: with c the vertex opposite to
// it, u the place of a chord on the way from c (0) to the base (1) and G(u) the mean of f over the
// chord,
//     int f = A int_0^1 2u G(u) du,
// A the area; the nodes are those of Gauss and Jacobi for the weight 2u. So n chords are exact
// where G is a polynomial of degree 2n - 1; each is a segment of u times the base's length.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace cs2mesh {

/// The numbers of chords that a triangle may be taken as.
inline constexpr std::array<int, 9> kChordCounts = {1, 2, 3, 4, 5, 6, 8, 10, 12};

struct Chord {
  double at;    ///< u, in (0, 1)
  double part;  ///< of the triangle's area; those of a rule add up to 1
};

namespace detail {

inline constexpr Chord kChords[] = {
#include "libfield/integral/chord_table.inc"
};

/// Where the chords of each rule begin.
inline constexpr std::array<std::size_t, kChordCounts.size()> kFirstChord = [] {
  std::array<std::size_t, kChordCounts.size()> first{};
  for (std::size_t i = 1; i < first.size(); ++i) {
    first[i] = first[i - 1] + static_cast<std::size_t>(kChordCounts[i - 1]);
  }
  return first;
}();

}  // namespace detail

/// The rule of kChordCounts[which] chords, from the vertex to the base.
constexpr std::span<const Chord> chord_rule(std::size_t which) {
  return std::span(detail::kChords)
      .subspan(detail::kFirstChord[which], static_cast<std::size_t>(kChordCounts[which]));
}

}  // namespace cs2mesh
