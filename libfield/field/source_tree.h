// The sources of a far field: points, segments and triangles of one kernel in a binary tree, each
// node with what its elements are together when seen from afar.
//
// Legend: nu, tau as in taylor_series.h; the field of an element of weight w is
// w int (|p - q|^2 + tau)^-nu dq, over the element or at its one point.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libfield/base/aabb.h"
#include "libfield/field/term.h"
#include "libfield/integral/far_sum.h"

namespace cs2mesh {

enum class FarShape : std::uint8_t { point, segment, triangle };

/// A point (length 0), a segment from `a` to `b`, or (of some area) a triangle whose shortest edge
/// is from `a` to `b`.
struct FarElement {
  Vec3d a, b;
  Vec3d apex;           ///< of a triangle alone
  double length = 0.0;  ///< of a triangle's longest edge
  double area = 0.0;
  double weight = 0.0;  ///< signed
  double tau = 0.0;
  std::uint32_t term = 0;

  /// Of the absolute value.
  double mass() const { return std::abs(weight) * measure(); }
  double measure() const { return is_triangle() ? area : length > 0 ? length : 1.0; }
  bool is_triangle() const { return area > 0; }
  FarShape shape() const {
    return is_triangle() ? FarShape::triangle : length > 0 ? FarShape::segment : FarShape::point;
  }
  Vec3d middle() const {
    const Vec3d half = 0.5 * (a + b);
    return is_triangle() ? half + (apex - half) / 3.0 : half;
  }
  Aabb box() const {
    Aabb box;
    box.include(a);
    box.include(b);
    if (is_triangle()) box.include(apex);
    return box;
  }
};

/// 2 nu of a kernel that reaches far as a power; none for the others.
std::optional<double> far_exponent(const Kernel& kernel);

/// The element of a term, if its kernel has a far exponent and it is a point, a segment or a
/// triangle that is no sliver, of moderate numbers, without profile and transformation.
std::optional<FarElement> far_element(const Term& term, std::uint32_t index);

/// The squared distance from p to an element, within a few ulp of itself and of the element's
/// squared length.
double squared_distance(const FarElement& element, const Vec3d& p);

/// A triangle takes about as long to sum as so many points or segments.
inline constexpr std::uint32_t kTriangleWork = 4;

struct SourceNode {
  Aabb box;
  Vec3d center;
  double radius = 0.0;  ///< about the centre, rounded up
  double mass = 0.0;
  double negative_mass = 0.0;            ///< the part of it that is subtracted
  double heaviest = 0.0, longest = 0.0;  ///< the greatest mass and length of an element
  double least_tau = 0.0;                ///< of the elements
  double tau = 0.0;                      ///< half way to the greatest
  double tau_spread = 0.0;               ///< the greatest distance from there
  std::uint32_t first = 0, count = 0;    ///< its elements
  std::uint32_t triangles = 0;           ///< among them
  std::uint32_t right = 0;               ///< the child that is not the next node; 0 for a leaf

  /// Its elements in units of one that is not a triangle.
  std::uint32_t work() const { return count + (kTriangleWork - 1) * triangles; }
};

/// Immutable. Built in O(n log n); some 250 bytes a point or segment, 800 a triangle, the double of
/// that where tau varies.
class SourceTree {
 public:
  SourceTree() = default;
  /// The elements are reordered.
  explicit SourceTree(std::vector<FarElement> elements);

  const std::vector<FarElement>& elements() const { return elements_; }
  /// Of an element, which need not be looked up for that.
  FarShape shape(std::uint32_t element) const { return shapes_[element]; }
  const SourceNode& node(std::uint32_t index) const { return nodes_[index]; }
  /// sum w t^j int (-q)^k / k! dq over the elements of a node, q from its centre in units of its
  /// radius, t from its tau in units of its spread; j < kTauOrders, 0 alone if there is no spread.
  /// The node must have moments.
  const double* moments(std::uint32_t node, int j) const {
    return moments_[first_moments_[node] + static_cast<std::size_t>(j)].data();
  }

  /// Nodes of few elements have none.
  bool has_moments(std::uint32_t node) const { return first_moments_[node] != kNoMoments; }

 private:
  static constexpr std::size_t kNoMoments = SIZE_MAX;

  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  std::size_t number_moments(std::uint32_t node, std::size_t first);
  void measure(std::uint32_t node);
  void measure_leaf(const SourceNode& node, std::span<Series> moments) const;
  void take_over(const SourceNode& node, std::uint32_t child, std::span<Series> moments) const;

  std::vector<FarElement> elements_;
  std::vector<FarShape> shapes_;
  std::vector<SourceNode> nodes_;
  std::unique_ptr<Series[]> moments_;       ///< of all nodes
  std::vector<std::size_t> first_moments_;  ///< by node
};

}  // namespace cs2mesh
