// A cell of the far field's octree.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "libfield/field/far_chords.h"
#include "libfield/field/far_field.h"
#include "libfield/integral/far_reach.h"

namespace cs2mesh {

/// A cube lo < p <= hi of the target octree.
struct FarField::Cell {
  Vec3d lo, hi, center;
  double half = 0.0;
  int level = 0;
  bool leaf = false;
  Series series{};        ///< of (p - center) / half
  double share = 0.0;     ///< of the cell's error budget, for one source
  OctantErrors errors{};  ///< bounds of that of the series, from the root on
  /// What is not in the series: nodes of the source tree, and elements.
  std::vector<std::uint32_t> nodes, elements;
  std::size_t listed = 0;  ///< elements in all of them, as SourceNode::work()
  // Of a leaf, the elements in them: those that are points, segments to be summed as so many nodes
  // (an entry of kFarNodes), triangles' chords likewise, segments and triangles whose closed form
  // will do (the latter by their numbers in triangles_), and what is near.
  std::vector<std::uint32_t> points;
  std::array<std::vector<std::uint32_t>, kFarNodes.size()> segments;
  std::array<std::vector<FarChord>, kFarNodes.size()> chords;
  std::vector<std::uint32_t> lines, triangles, near;
  mutable std::array<std::atomic<Cell*>, 8> children{};

  Cell() = default;
  Cell(const Cell&) = delete;
  Cell& operator=(const Cell&) = delete;
  ~Cell() {
    for (auto& child : children) delete child.load(std::memory_order_relaxed);
  }

  bool holds(const Vec3d& p) const {
    return lo.x < p.x && p.x <= hi.x && lo.y < p.y && p.y <= hi.y && lo.z < p.z && p.z <= hi.z;
  }
  bool holds(const Aabb& box) const { return holds(box.min) && holds(box.max); }
  int octant_of(const Vec3d& p) const {
    return (p.x > center.x ? 1 : 0) + (p.y > center.y ? 2 : 0) + (p.z > center.z ? 4 : 0);
  }
  /// Gives back what only a leaf needs.
  void forget_shares() {
    points = {}, lines = {}, triangles = {}, near = {};
    for (auto& some : segments) some = {};
    for (auto& some : chords) some = {};
  }
  struct SeriesBounds {
    double size = 0.0;     ///< sum of the absolute values of its coefficients
    double hessian = 0.0;  ///< >= the norm of its second derivative
    double third = 0.0;    ///< and of its third
  };
  /// Found when first asked for: values want none.
  const SeriesBounds& series_bounds() const;
  /// From the centre to a corner, rounded up.
  double radius() const { return 1.7320508075688774 * (1 + 1e-12) * half; }

 private:
  mutable std::once_flag measured_;
  mutable SeriesBounds series_bounds_;
};

template <class Visit>
void FarField::visit_unresolved(const Cell& cell, const Visit& visit) const {
  for (const std::uint32_t index : cell.nodes) {
    const SourceNode& node = tree_.node(index);
    for (std::uint32_t i = 0; i < node.count; ++i) visit(node.first + i);
  }
  for (const std::uint32_t element : cell.elements) visit(element);
}

}  // namespace cs2mesh
