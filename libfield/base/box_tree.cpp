#include "libfield/base/box_tree.h"

#include <algorithm>
#include <numeric>

namespace cs2mesh {
namespace {

constexpr std::uint32_t kLeafSize = 4;

/// A finite stand-in for the centre of a box that may be unbounded.
Vec3d sort_key(const Aabb& box) {
  Vec3d key;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double middle = 0.5 * (box.min[axis] + box.max[axis]);
    key[axis] = std::isfinite(middle) ? middle : 0.0;
  }
  return key;
}

}  // namespace

BoxTree::BoxTree(std::vector<Aabb> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  nodes_.reserve(boxes_.size());
  if (!boxes_.empty()) build(0, static_cast<std::uint32_t>(boxes_.size()));
}

void BoxTree::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Aabb box;
  Aabb keys;
  for (std::uint32_t i = first; i < first + count; ++i) {
    box.include(boxes_[order_[i]]);
    keys.include(sort_key(boxes_[order_[i]]));
  }
  nodes_[self].box = box;
  if (count <= kLeafSize) {
    nodes_[self].first = first;
    nodes_[self].count = count;
    return;
  }
  const std::size_t axis = longest_axis(keys.extent());
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double ka = sort_key(boxes_[a])[axis];
    const double kb = sort_key(boxes_[b])[axis];
    return ka != kb ? ka < kb : a < b;
  });
  build(first, half);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build(first + half, count - half);
}

void BoxTree::overlapping(const Aabb& query, std::vector<std::uint32_t>& found) const {
  if (nodes_.empty()) return;
  std::uint32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!node.box.overlaps(query)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (boxes_[order_[i]].overlaps(query)) found.push_back(order_[i]);
    }
  }
}

}  // namespace cs2mesh
