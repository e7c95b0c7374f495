// All pairs of overlapping boxes, by a tree over their Morton order.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libfield/base/aabb.h"
#include "polygonize/morton.h"

namespace cs2mesh {

/// A tree with eight children a node. Boxes are closed: those that touch overlap. O(n log n) to
/// build; a query costs about the logarithm and what it finds where boxes are not much larger than
/// the distances between them.
class BoxPairs {
 public:
  /// The boxes are finite and not empty.
  explicit BoxPairs(std::span<const Aabb> boxes);

  /// Boxes are looked at in groups of up to eight.
  std::size_t group_count() const { return levels_[1].size(); }

  /// Calls f(i, j) for overlapping boxes i and j, in any order of the two: every pair turns up in
  /// exactly one group, in the same order each time.
  template <class F>
  void for_each_pair(std::size_t group, F&& f) const {
    const std::size_t top = levels_.size() - 1;
    visit(group, top, 0, levels_[top].size(), f);
  }

 private:
  static constexpr std::size_t kChildren = 8;

  /// Pairs of `group` with itself and later groups, among the nodes first .. last of a level.
  template <class F>
  void visit(std::size_t group, std::size_t level, std::size_t first, std::size_t last,
             F& f) const {
    const std::vector<Aabb>& nodes = levels_[level];
    for (std::size_t n = first; n < std::min(last, nodes.size()); ++n) {
      const std::size_t groups_end = (n + 1) << (3 * (level - 1));
      if (groups_end <= group || !nodes[n].overlaps(levels_[1][group])) continue;
      if (level == 1) {
        compare(group, n, f);
      } else {
        visit(group, level - 1, kChildren * n, kChildren * (n + 1), f);
      }
    }
  }

  template <class F>
  void compare(std::size_t group, std::size_t other, F& f) const {
    const std::vector<Aabb>& boxes = levels_[0];
    const std::size_t a_end = std::min(kChildren * (group + 1), boxes.size());
    const std::size_t b_end = std::min(kChildren * (other + 1), boxes.size());
    for (std::size_t a = kChildren * group; a < a_end; ++a) {
      if (!boxes[a].overlaps(levels_[1][other])) continue;
      for (std::size_t b = std::max(a + 1, kChildren * other); b < b_end; ++b) {
        if (boxes[a].overlaps(boxes[b])) f(order_[a].second, order_[b].second);
      }
    }
  }

  /// Morton code and number of each box, sorted.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  /// Boxes in that order, then the boxes of eight, of 64, ...
  std::vector<std::vector<Aabb>> levels_;
};

inline BoxPairs::BoxPairs(std::span<const Aabb> boxes) : order_(boxes.size()), levels_(2) {
  Aabb all;
  for (const Aabb& box : boxes) all.include(box);
  tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t i) {
    // Halves first, lest the sum overflow.
    const Vec3d middle = 0.5 * boxes[i].min + 0.5 * boxes[i].max;
    order_[i] = {morton_code(all, middle), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(order_.begin(), order_.end());
  levels_[0].reserve(boxes.size());
  for (const auto& [code, i] : order_) levels_[0].push_back(boxes[i]);
  for (std::size_t level = 1; level == 1 || levels_[level - 1].size() > kChildren; ++level) {
    levels_.resize(level + 1);
    const std::vector<Aabb>& below = levels_[level - 1];
    levels_[level].resize((below.size() + kChildren - 1) / kChildren);
    for (std::size_t i = 0; i < below.size(); ++i) levels_[level][i / kChildren].include(below[i]);
  }
}

}  // namespace cs2mesh
