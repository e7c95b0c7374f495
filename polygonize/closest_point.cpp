#include "polygonize/closest_point.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kLeafSize = 4;
constexpr int kBins = 16;
/// Where splits by cost have gone this deep they are of no use (many equal triangles); halving from
/// there on bounds the depth by kCostDepth + 32, for which the stacks of the walks have room.
constexpr int kCostDepth = 48;
constexpr std::size_t kStackSize = 96;

double half_surface(const Aabb& box) {
  if (box.empty()) return 0;
  const Vec3d e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

double squared_distance(const Aabb& box, const Vec3d& p) {
  return squared_norm(p - box.clamp(p));
}

/// The point of segment ab nearest to p.
Vec3d nearest_on_segment(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d d = b - a;
  const double length2 = squared_norm(d);
  const double t = dot(p - a, d);
  if (!(t > 0) || length2 == 0) return a;
  return t >= length2 ? b : a + (t / length2) * d;
}

struct Candidate {
  double squared = kInfinity;
  Vec3d point;

  void take(const Vec3d& q, const Vec3d& p) {
    const double d = squared_norm(q - p);
    if (d < squared) *this = {d, q};
  }
};

}  // namespace

Vec3d nearest_on_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p) {
  const Vec3d n = cross(b - a, c - a);
  // Barycentric weights times |n|^2; a negative one means that p is beyond the edge opposite.
  const double wa = dot(n, cross(c - b, p - b));
  const double wb = dot(n, cross(a - c, p - c));
  const double wc = dot(n, cross(b - a, p - a));
  Candidate best;
  const double sum = wa + wb + wc;
  if (wa > 0 && wb > 0 && wc > 0 && sum < kInfinity) {
    return a + (wb / sum) * (b - a) + (wc / sum) * (c - a);
  }
  // The nearest point lies on an edge that p is beyond.
  if (!(wa > 0)) best.take(nearest_on_segment(b, c, p), p);
  if (!(wb > 0)) best.take(nearest_on_segment(c, a, p), p);
  if (!(wc > 0)) best.take(nearest_on_segment(a, b, p), p);
  return best.point;
}

// ---- Building ----

class ClosestPoint::Builder {
 public:
  Builder(const TriangleMesh& mesh, ClosestPoint& tree) : tree_(tree) {
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    items_.resize(count);
    for (std::uint32_t t = 0; t < count; ++t) {
      for (const auto vertex : mesh.triangles[t]) items_[t].box.include(mesh.positions[vertex]);
      items_[t].center = items_[t].box.center();
      items_[t].triangle = t;
    }
    tree_.root_ = build(0, count, 0, tree_.nodes_);
    tree_.corners_.reserve(count);
    for (const Item& item : items_) {
      const auto& [a, b, c] = mesh.triangles[item.triangle];
      tree_.corners_.push_back({mesh.positions[a], mesh.positions[b], mesh.positions[c]});
      tree_.triangle_of_.push_back(item.triangle);
    }
  }

 private:
  struct Item {
    Aabb box;
    Vec3d center;
    std::uint32_t triangle;
  };

  /// Appends the nodes below the child that holds items [begin, end).
  Child build(std::uint32_t begin, std::uint32_t end, int depth, std::vector<Node>& nodes) {
    Child result;
    for (std::uint32_t i = begin; i < end; ++i) result.box.include(items_[i].box);
    if (end - begin <= kLeafSize) {
      result.first = begin;
      result.count = end - begin;
      return result;
    }
    const std::uint32_t middle = split(begin, end, depth);
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.emplace_back();
    Child left, right;
    constexpr std::uint32_t kAlone = 1U << 15U;
    if (end - begin <= kAlone) {
      left = build(begin, middle, depth + 1, nodes);
      right = build(middle, end, depth + 1, nodes);
    } else {
      std::vector<Node> left_nodes, right_nodes;
      tbb::parallel_invoke([&] { left = build(begin, middle, depth + 1, left_nodes); },
                           [&] { right = build(middle, end, depth + 1, right_nodes); });
      append(left, left_nodes, nodes);
      append(right, right_nodes, nodes);
    }
    nodes[index] = {{left, right}};
    result.first = index;
    return result;
  }

  /// Moves the nodes of a subtree behind `nodes`.
  static void append(Child& root, std::vector<Node>& subtree, std::vector<Node>& nodes) {
    const auto offset = static_cast<std::uint32_t>(nodes.size());
    const auto shift = [offset](Child& child) {
      if (child.count == 0) child.first += offset;
    };
    shift(root);
    for (Node& node : subtree) {
      for (Child& child : node.child) shift(child);
    }
    nodes.insert(nodes.end(), subtree.begin(), subtree.end());
  }

  /// Orders items [begin, end) and returns where the second half starts, by the least sum of
  /// (surface of the box x number of triangles) over kBins places along the longest axis.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, int depth) {
    Aabb centers;
    for (std::uint32_t i = begin; i < end; ++i) centers.include(items_[i].center);
    const Vec3d extent = centers.extent();
    const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                             : extent.y >= extent.z                       ? 1
                                                                          : 2;
    const double low = centers.min[axis];
    const double scale = kBins / extent[axis];
    if (depth >= kCostDepth || !(scale < kInfinity)) return halve(begin, end, axis);
    const auto bin_of = [&](const Item& item) {
      return std::clamp(static_cast<int>((item.center[axis] - low) * scale), 0, kBins - 1);
    };
    const int cut = cheapest_cut(begin, end, bin_of);
    const auto first = items_.begin() + begin, last = items_.begin() + end;
    const auto middle =
        std::partition(first, last, [&](const Item& item) { return bin_of(item) <= cut; });
    if (middle == first || middle == last) return halve(begin, end, axis);
    return static_cast<std::uint32_t>(middle - items_.begin());
  }

  /// The bin after which to cut.
  template <class BinOf>
  int cheapest_cut(std::uint32_t begin, std::uint32_t end, const BinOf& bin_of) const {
    std::array<Aabb, kBins> boxes;
    std::array<std::uint32_t, kBins> counts{};
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(items_[i]));
      boxes[bin].include(items_[i].box);
      ++counts[bin];
    }
    std::array<double, kBins> cost_right{};
    Aabb box;
    std::uint32_t count = 0;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      box.include(boxes[bin]);
      count += counts[bin];
      cost_right[bin - 1] = half_surface(box) * count;
    }
    box = {};
    count = 0;
    int best = 0;
    double best_cost = kInfinity;
    for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
      box.include(boxes[bin]);
      count += counts[bin];
      const double cost = half_surface(box) * count + cost_right[bin];
      if (cost < best_cost) {
        best_cost = cost;
        best = static_cast<int>(bin);
      }
    }
    return best;
  }

  std::uint32_t halve(std::uint32_t begin, std::uint32_t end, std::size_t axis) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [axis](const Item& a, const Item& b) {
                       return std::pair(a.center[axis], a.triangle) <
                              std::pair(b.center[axis], b.triangle);
                     });
    return middle;
  }

  ClosestPoint& tree_;
  std::vector<Item> items_;
};

ClosestPoint::ClosestPoint(const TriangleMesh& mesh) {
  Builder(mesh, *this);
}

// ---- Nearest point ----

ClosestPoint::Hit ClosestPoint::nearest(const Vec3d& p, double upper_bound) const {
  Candidate best;
  best.squared = upper_bound * upper_bound;
  std::uint32_t found = kNone;
  std::array<std::pair<const Child*, double>, kStackSize> stack;
  std::size_t size = 0;
  stack[size++] = {&root_, squared_distance(root_.box, p)};
  while (size > 0) {
    const auto [child, squared] = stack[--size];
    if (squared >= best.squared) continue;
    if (child->count > 0) {
      for (std::uint32_t i = child->first; i < child->first + child->count; ++i) {
        const double before = best.squared;
        best.take(nearest_on_triangle(corners_[i].a, corners_[i].b, corners_[i].c, p), p);
        if (best.squared < before) found = i;
      }
    } else if (!nodes_.empty()) {
      const Node& node = nodes_[child->first];
      std::pair<const Child*, double> near{&node.child[0], squared_distance(node.child[0].box, p)};
      std::pair<const Child*, double> far{&node.child[1], squared_distance(node.child[1].box, p)};
      if (far.second < near.second) std::swap(near, far);
      if (far.second < best.squared) stack[size++] = far;
      if (near.second < best.squared) stack[size++] = near;
    }
  }
  if (found == kNone) return {};
  return {std::sqrt(best.squared), triangle_of_[found], best.point};
}

// ---- Rays ----

/// One ray, with the shear that turns it into the z axis.
class ClosestPoint::RayWalk {
 public:
  RayWalk(const Vec3d& origin, const Vec3d& direction, double t0)
      : origin_(origin), t0_(t0), inverse_{1 / direction.x, 1 / direction.y, 1 / direction.z} {
    const Vec3d size{std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)};
    kz_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    kx_ = (kz_ + 1) % 3;
    ky_ = (kz_ + 2) % 3;
    shear_ = {direction[kx_] / direction[kz_], direction[ky_] / direction[kz_], 1 / direction[kz_]};
  }

  /// Whether the box meets [t0, t1]; never wrongly no.
  bool meets(const Aabb& box, double t1) const {
    double low = t0_, high = t1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool backwards = std::signbit(inverse_[axis]);
      const double in = ((backwards ? box.max : box.min)[axis] - origin_[axis]) * inverse_[axis];
      const double out = ((backwards ? box.min : box.max)[axis] - origin_[axis]) * inverse_[axis];
      // NaN, from a ray inside a face of the box, leaves the bounds as they are. Two subtractions
      // and products cost at most 4 units of rounding.
      low = in > low ? in - kSlack * std::abs(in) : low;
      high = out < high ? out + kSlack * std::abs(out) : high;
    }
    return low <= high;
  }

  /// t of the crossing, NaN if there is none.
  double crossing(const Corners& triangle) const {
    const Vec3d a = sheared(triangle.a), b = sheared(triangle.b), c = sheared(triangle.c);
    const double u = c.x * b.y - c.y * b.x;
    const double v = a.x * c.y - a.y * c.x;
    const double w = b.x * a.y - b.y * a.x;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kNaN;
    const double sum = u + v + w;
    return sum == 0 ? kNaN : (u * a.z + v * b.z + w * c.z) / sum;
  }

  /// Calls on_hit(t) for all crossings in [t0, limit]; on_hit returns the new limit.
  template <class OnHit>
  void walk(const ClosestPoint& tree, double limit, OnHit on_hit) const {
    std::array<const Child*, kStackSize> stack;
    std::size_t size = 0;
    stack[size++] = &tree.root_;
    while (size > 0) {
      const Child* child = stack[--size];
      if (!meets(child->box, limit)) continue;
      for (std::uint32_t i = child->first; i < child->first + child->count; ++i) {
        const double t = crossing(tree.corners_[i]);
        if (t >= t0_ && t <= limit) limit = on_hit(t);
      }
      if (child->count > 0 || tree.nodes_.empty()) continue;
      const Node& node = tree.nodes_[child->first];
      const bool second_first =
          (node.child[1].box.center()[kz_] - node.child[0].box.center()[kz_]) * shear_.z < 0;
      stack[size++] = &node.child[second_first ? 0 : 1];
      stack[size++] = &node.child[second_first ? 1 : 0];
    }
  }

 private:
  static constexpr double kSlack = 8 * std::numeric_limits<double>::epsilon();
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  Vec3d sheared(const Vec3d& corner) const {
    const Vec3d p = corner - origin_;
    return {p[kx_] - shear_.x * p[kz_], p[ky_] - shear_.y * p[kz_], shear_.z * p[kz_]};
  }

  Vec3d origin_;
  double t0_;
  Vec3d inverse_;
  Vec3d shear_;
  std::size_t kx_ = 0, ky_ = 1, kz_ = 2;
};

std::vector<double> ClosestPoint::all_hits(const Vec3d& origin, const Vec3d& direction, double t0,
                                           double t1) const {
  std::vector<double> hits;
  RayWalk(origin, direction, t0).walk(*this, t1, [&](double t) {
    hits.push_back(t);
    return t1;
  });
  std::sort(hits.begin(), hits.end());
  return hits;
}

double ClosestPoint::first_hit(const Vec3d& origin, const Vec3d& direction, double t0,
                               double t1) const {
  double first = kInfinity;
  RayWalk(origin, direction, t0).walk(*this, t1, [&](double t) { return first = t; });
  return first;
}

}  // namespace cs2mesh
