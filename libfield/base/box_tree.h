// A bounding volume hierarchy over boxes, for queries that ask which boxes meet a box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libfield/base/aabb.h"

namespace cs2mesh {

/// Immutable; built in O(n log n) by splitting at the median of the longest axis of the centres.
/// Boxes may be infinite.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Aabb> boxes);

  /// Appends the index of every box that overlaps `query`, in no particular order.
  void overlapping(const Aabb& query, std::vector<std::uint32_t>& found) const;

  const Aabb& box(std::uint32_t index) const { return boxes_[index]; }
  std::size_t size() const { return boxes_.size(); }

 private:
  struct Node {
    Aabb box;
    std::uint32_t first = 0;  ///< a leaf's first place in order_, an inner node's right child
    std::uint32_t count = 0;  ///< 0: inner node, its left child is the next node
  };
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cs2mesh
