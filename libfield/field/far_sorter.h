// Sorts what a cell of a far field has to sum by how far it is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libfield/field/far_cell.h"
#include "libfield/field/far_remainders.h"
#include "libfield/integral/far_reach.h"
#include "libfield/integral/far_sum.h"
#include "libfield/integral/harmonics.h"

namespace cs2mesh {

class FarField::Sorter {
 public:
  Sorter(const FarField& field, Cell& cell) : field_(field), cell_(cell) {}

  /// Moves what is far enough of these nodes and elements into the cell's series, and the others
  /// into its lists. Returns bounds of the error in the cell, at most `budget`; `guess` is the
  /// first try of the share of it that one source may have.
  OctantErrors sort(const std::vector<std::uint32_t>& nodes,
                    const std::vector<std::uint32_t>& elements, double budget, double guess);

  /// Divides what a leaf still lists into what is near and what a few points stand for.
  void finish(double budget);

 private:
  /// An element, or one of chords_, that goes into the series.
  struct Taken {
    std::uint32_t element;
    FarChoice choice;
  };

  void clear();
  void sort_every(std::size_t step, const std::vector<std::uint32_t>& nodes,
                  const std::vector<std::uint32_t>& elements, double each);
  void sort_node(std::uint32_t index, double each);
  enum class Reach { far, mixed, near };
  Reach take_elements(std::uint32_t index, double each);
  bool take_cluster(std::uint32_t index, const Vec3d& d, double s, double q, double each);
  double corner_share(double reach, double s, double radius) const;
  double spread_remainder(double q, double spread) const;
  void add_single(std::uint32_t element, double each);
  void sort_single(double each);
  /// An entry of kNodeRules, with a bound of the error that comes with it.
  struct Rule {
    std::size_t entry = 0;
    double error = 0.0;
  };
  std::optional<Rule> nodes_for(double length, double mass, double s,
                                std::span<const NodeBound> counts, double most) const;
  std::optional<Rule> rule_for(double length, double mass, double s, double most) const;
  /// A triangle as chords: an entry of kChordCounts, and for each chord one of the counts.
  struct ChordChoice {
    std::size_t rule = 0;
    std::array<std::uint8_t, kChordCounts.back()> nodes{};
    int total = 0;  ///< of nodes
    double error = 0.0;
  };
  std::optional<ChordChoice> chords_for(const FarElement& triangle, double s,
                                        std::span<const NodeBound> counts, double most) const;
  double nearest2(double d2, double tau) const;
  void sort_triangle(std::uint32_t index, double each);
  void take_triangle(std::uint32_t index, std::size_t order, const ChordChoice& choice);
  void finish_segments(const std::vector<std::uint32_t>& segments, double budget);
  double list_near(std::uint32_t segment, double each);
  void finish_triangles(const std::vector<std::uint32_t>& triangles, double budget);
  double list_triangle(std::uint32_t index, double s, double each);
  void sum_up();
  void sum_up_elements();
  void add_taken(std::span<const Taken> taken, const SegmentSource* sources,
                 HarmonicSums& sums) const;

  const FarField& field_;
  Cell& cell_;
  OctantErrors errors_{};
  std::array<std::vector<SeriesSource>, kTauOrders> clusters_;  ///< by the power of tau
  std::vector<std::uint32_t> single_;  ///< elements that wait to be sorted one by one
  std::vector<FarChoice> choices_;     ///< of these
  std::vector<Taken> taken_, taken_chords_;
  std::vector<FarChord> chords_;  ///< of triangles that go into the series
};

}  // namespace cs2mesh
