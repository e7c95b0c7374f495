#include "polygonize/check.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "polygonize/disjoint_sets.h"
#include "polygonize/self_intersection.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A use of an edge by a triangle, seen from the edge's lower vertex. Half-edge 3 t + i runs from
/// corner i to corner i + 1 of triangle t.
struct EdgeUse {
  Index other = 0;  ///< the edge's higher vertex
  std::uint32_t half_edge = 0;
  bool upwards = false;  ///< runs from the lower to the higher vertex
  friend bool operator<(const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.other, a.half_edge) < std::tie(b.other, b.half_edge);
  }
};

struct Component {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t triangles = 0;
  bool closed = true;
  double volume = 0.0;
  Aabb box;
  std::uint32_t first = kNone;  ///< its first triangle
};

class Checker {
 public:
  Checker(const TriangleMesh& mesh, const CheckOptions& options) : mesh_(mesh), options_(options) {}
  MeshReport run();

 private:
  void check_indices();
  void check_duplicates();
  void check_degenerate();
  void collect_edges();
  void check_edges();
  void check_edge(Index low, std::span<const EdgeUse> uses);
  void check_vertices();
  std::size_t fan_size(std::uint32_t half_edge, std::size_t limit) const;
  void check_components();
  void count_vertices(std::vector<Component>& components) const;
  void check_outward(const std::vector<Component>& components);
  void check_self_intersections();
  void add(DefectKind kind, const Vec3d& where, std::vector<Index> triangles);

  const std::array<Index, 3>& corners(std::size_t t) const { return mesh_.triangles[valid_[t]]; }
  Vec3d corner(std::size_t t, std::size_t i) const { return mesh_.positions[corners(t)[i]]; }
  Vec3d centroid(std::size_t t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0; }

  const TriangleMesh& mesh_;
  const CheckOptions& options_;
  MeshReport report_;
  /// Triangles with valid indices; all later numbers of triangles are places in this list.
  std::vector<Index> valid_;
  std::vector<std::size_t> edge_begin_;  ///< by lower vertex, into edge_uses_
  std::vector<EdgeUse> edge_uses_;
  std::vector<std::uint32_t> opposite_;   ///< the other half-edge of an edge with two uses
  std::vector<std::uint32_t> component_;  ///< by triangle: a representative
};

void Checker::add(DefectKind kind, const Vec3d& where, std::vector<Index> triangles) {
  std::size_t& count = report_.counts[static_cast<std::size_t>(kind)];
  if (count++ < options_.max_defects) {
    report_.defects.push_back({kind, where, std::move(triangles)});
  }
}

void Checker::check_indices() {
  const std::size_t n = mesh_.positions.size();
  valid_.reserve(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& corners = mesh_.triangles[t];
    if (std::all_of(corners.begin(), corners.end(), [n](Index v) { return v < n; })) {
      valid_.push_back(static_cast<Index>(t));
    } else {
      add(DefectKind::index_out_of_range, {}, {static_cast<Index>(t)});
    }
  }
  for (const Vec3d& p : mesh_.positions) {
    if (!is_finite(p)) add(DefectKind::not_finite, p, {});
  }
}

void Checker::check_duplicates() {
  std::vector<Index> order;
  order.reserve(mesh_.positions.size());
  for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
    if (is_finite(mesh_.positions[v])) order.push_back(static_cast<Index>(v));
  }
  tbb::parallel_sort(order.begin(), order.end(), [this](Index a, Index b) {
    const Vec3d& p = mesh_.positions[a];
    const Vec3d& q = mesh_.positions[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  });
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Vec3d& p = mesh_.positions[order[i]];
    if (p == mesh_.positions[order[i - 1]]) add(DefectKind::duplicate_vertex, p, {});
  }
}

void Checker::check_degenerate() {
  std::vector<char> degenerate(valid_.size());
  tbb::parallel_for(std::size_t{0}, valid_.size(), [&](std::size_t t) {
    degenerate[t] = is_degenerate(corner(t, 0), corner(t, 1), corner(t, 2)) ? 1 : 0;
  });
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    if (degenerate[t] != 0) add(DefectKind::degenerate_triangle, centroid(t), {valid_[t]});
  }
}

/// Sorts the uses of edges by lower vertex (by counting), then by higher vertex.
void Checker::collect_edges() {
  const std::size_t n = mesh_.positions.size();
  edge_begin_.assign(n + 1, 0);
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++edge_begin_[std::min(corners(t)[i], corners(t)[(i + 1) % 3]) + 1U];
    }
  }
  std::partial_sum(edge_begin_.begin(), edge_begin_.end(), edge_begin_.begin());
  std::vector<std::size_t> place(edge_begin_.begin(), edge_begin_.end() - 1);
  edge_uses_.resize(3 * valid_.size());
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::pair(corners(t)[i], corners(t)[(i + 1) % 3]);
      edge_uses_[place[std::min(a, b)]++] = {std::max(a, b), static_cast<std::uint32_t>(3 * t + i),
                                             a < b};
    }
  }
  tbb::parallel_for(std::size_t{0}, n, [this](std::size_t v) {
    std::sort(edge_uses_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[v]),
              edge_uses_.begin() + static_cast<std::ptrdiff_t>(edge_begin_[v + 1]));
  });
}

/// Calls f(lower vertex, uses) for every edge.
template <class F>
void for_each_edge(const std::vector<std::size_t>& begin, const std::vector<EdgeUse>& uses, F&& f) {
  for (std::size_t v = 0; v + 1 < begin.size(); ++v) {
    for (std::size_t i = begin[v]; i < begin[v + 1];) {
      std::size_t end = i;
      while (end < begin[v + 1] && uses[end].other == uses[i].other) ++end;
      f(static_cast<Index>(v), std::span<const EdgeUse>(uses.data() + i, end - i));
      i = end;
    }
  }
}

void Checker::check_edges() {
  opposite_.assign(3 * valid_.size(), kNone);
  for_each_edge(edge_begin_, edge_uses_,
                [this](Index low, std::span<const EdgeUse> uses) { check_edge(low, uses); });
}

void Checker::check_edge(Index low, std::span<const EdgeUse> uses) {
  if (uses.size() == 2) {
    opposite_[uses[0].half_edge] = uses[1].half_edge;
    opposite_[uses[1].half_edge] = uses[0].half_edge;
    if (uses[0].upwards != uses[1].upwards) return;
  }
  const DefectKind kind = uses.size() == 1   ? DefectKind::open_edge
                          : uses.size() == 2 ? DefectKind::inconsistent_orientation
                                             : DefectKind::nonmanifold_edge;
  std::vector<Index> triangles;
  for (const EdgeUse& use : uses) triangles.push_back(valid_[use.half_edge / 3]);
  add(kind, 0.5 * (mesh_.positions[low] + mesh_.positions[uses[0].other]), std::move(triangles));
}

/// How many triangles are in the fan around the vertex at which a half-edge starts; at most a
/// little over `limit`, where triangles that name a vertex twice lead the walk astray.
std::size_t Checker::fan_size(std::uint32_t half_edge, std::size_t limit) const {
  const auto next = [](std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
  const auto previous = [](std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; };
  const Index vertex = corners(half_edge / 3)[half_edge % 3];
  std::size_t size = 1;
  // Around one way until back in the first triangle or at an open edge; from there, the other way.
  for (const std::uint32_t start : {previous(half_edge), half_edge}) {
    std::uint32_t edge = start;  // at the vertex, of the triangle last visited
    while (size <= limit) {
      const std::uint32_t across = opposite_[edge];
      if (across == kNone) break;
      if (across / 3 == half_edge / 3) return size;
      ++size;
      const bool starts_here = corners(across / 3)[across % 3] == vertex;
      edge = starts_here ? previous(across) : next(across);
    }
  }
  return size;
}

void Checker::check_vertices() {
  std::vector<std::uint32_t> degree(mesh_.positions.size(), 0);
  std::vector<std::uint32_t> first(mesh_.positions.size(), kNone);
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Index v = corners(t)[i];
      ++degree[v];
      if (first[v] == kNone) first[v] = static_cast<std::uint32_t>(3 * t + i);
    }
  }
  std::vector<char> broken(mesh_.positions.size());
  tbb::parallel_for(std::size_t{0}, broken.size(), [&](std::size_t v) {
    broken[v] = first[v] != kNone && fan_size(first[v], degree[v]) != degree[v] ? 1 : 0;
  });
  for (std::size_t v = 0; v < broken.size(); ++v) {
    if (broken[v] == 0) continue;
    add(DefectKind::nonmanifold_vertex, mesh_.positions[v], {valid_[first[v] / 3]});
  }
}

void Checker::check_components() {
  // Number the components in the order of their first triangles.
  DisjointSets sets(valid_.size());
  for_each_edge(edge_begin_, edge_uses_, [&](Index, std::span<const EdgeUse> uses) {
    for (const EdgeUse& use : uses) sets.join(uses[0].half_edge / 3, use.half_edge / 3);
  });
  std::vector<std::uint32_t> number(valid_.size(), kNone);
  std::vector<Component> components;
  component_.resize(valid_.size());
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    std::uint32_t& n = number[sets.root(static_cast<std::uint32_t>(t))];
    if (n == kNone) {
      n = static_cast<std::uint32_t>(components.size());
      components.push_back({});
      components.back().first = static_cast<std::uint32_t>(t);
    }
    component_[t] = n;
    for (std::size_t i = 0; i < 3; ++i) components[n].box.include(corner(t, i));
  }

  // Measure them.
  for_each_edge(edge_begin_, edge_uses_, [&](Index, std::span<const EdgeUse> uses) {
    Component& c = components[component_[uses[0].half_edge / 3]];
    ++c.edges;
    if (uses.size() != 2) c.closed = false;
  });
  count_vertices(components);
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    Component& c = components[component_[t]];
    ++c.triangles;
    // Volume about the middle of the box: the origin may be far away.
    const Vec3d o = c.box.center();
    c.volume += dot(corner(t, 0) - o, cross(corner(t, 1) - o, corner(t, 2) - o)) / 6.0;
  }

  report_.components = components.size();
  for (const Component& c : components) {
    report_.volume += c.volume;
    if (!c.closed) continue;
    const auto euler =
        static_cast<long long>(c.vertices + c.triangles) - static_cast<long long>(c.edges);
    report_.genus += (2 - euler) / 2;
  }
  check_outward(components);
}

/// A vertex counts once for each component that it is part of.
void Checker::count_vertices(std::vector<Component>& components) const {
  std::vector<std::uint32_t> first(mesh_.positions.size(), kNone);
  std::vector<std::pair<Index, std::uint32_t>> others;
  for (std::size_t t = 0; t < valid_.size(); ++t) {
    for (const Index v : corners(t)) {
      if (first[v] == kNone) {
        first[v] = component_[t];
        ++components[component_[t]].vertices;
      } else if (first[v] != component_[t]) {
        others.emplace_back(v, component_[t]);
      }
    }
  }
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const auto& [vertex, n] : others) ++components[n].vertices;
}

void Checker::check_outward(const std::vector<Component>& components) {
  std::vector<const Component*> solid;
  for (const Component& c : components) {
    if (c.volume > 0) solid.push_back(&c);
  }
  for (const Component& c : components) {
    if (!(c.volume < 0)) continue;
    const bool enclosed = std::any_of(solid.begin(), solid.end(), [&](const Component* other) {
      return other->box.contains(c.box);
    });
    if (enclosed) {
      ++report_.voids;
    } else {
      add(DefectKind::inward_component, c.box.center(), {valid_[c.first]});
    }
  }
}

void Checker::check_self_intersections() {
  if (!options_.self_intersections) return;
  if (cancelled(options_.progress)) return;
  if (report_.count(DefectKind::index_out_of_range) + report_.count(DefectKind::not_finite) > 0) {
    return;
  }
  const auto found = find_self_intersections(mesh_, options_.max_defects);
  if (!found) return;
  report_.self_intersections = found->count;
  for (const auto& pair : found->pairs) {
    add(DefectKind::self_intersection, cs2mesh::centroid(mesh_, pair[0]), {pair[0], pair[1]});
  }
  report_.counts[static_cast<std::size_t>(DefectKind::self_intersection)] = found->count;
}

MeshReport Checker::run() {
  report_.vertices = mesh_.positions.size();
  report_.triangles = mesh_.triangles.size();
  check_indices();
  check_duplicates();
  check_degenerate();
  collect_edges();
  check_edges();
  check_vertices();
  check_components();
  for (std::size_t t = 0; t < valid_.size(); ++t)
    report_.area += norm(area_vector(mesh_, valid_[t]));
  report_.shapes = triangle_shapes(mesh_);
  check_self_intersections();
  const auto none = [this](DefectKind kind) { return report_.count(kind) == 0; };
  const bool complete = none(DefectKind::index_out_of_range);
  report_.manifold_edges = complete && none(DefectKind::nonmanifold_edge);
  report_.closed = complete && none(DefectKind::open_edge);
  report_.manifold_vertices = complete && none(DefectKind::nonmanifold_vertex);
  report_.oriented =
      complete && report_.manifold_edges && none(DefectKind::inconsistent_orientation);
  report_.outward = report_.oriented && none(DefectKind::inward_component);
  return std::move(report_);
}

// Exact arithmetic on sums of doubles (Dekker 1971, Shewchuk 1997): a sum is kept as terms whose
// exact sum it is.

struct TwoTerms {
  double high, low;
};

TwoTerms exact_sum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  const double a_part = sum - b_part;
  return {sum, (a - a_part) + (b - b_part)};
}

TwoTerms exact_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

/// Whether doubles sum to exactly zero: each is added to an expansion of terms that do not overlap,
/// which is zero only if every term is.
class ZeroSum {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const TwoTerms s = exact_sum(x, terms_[i]);
      x = s.high;
      if (s.low != 0) terms_[kept++] = s.low;
    }
    if (x != 0) terms_[kept++] = x;
    size_ = kept;
  }
  void add_product(TwoTerms a, TwoTerms b, double sign) {
    for (const double p : {a.low, a.high}) {
      for (const double q : {b.low, b.high}) {
        const TwoTerms product = exact_product(p, q);
        add(sign * product.low);
        add(sign * product.high);
      }
    }
  }
  bool is_zero() const { return size_ == 0; }

 private:
  std::array<double, 32> terms_{};
  std::size_t size_ = 0;
};

}  // namespace

bool is_degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d u = b - a;
  const Vec3d v = c - a;
  const Vec3d normal = cross(u, v);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    // Two differences, two products, one difference: each rounds by at most 2^-53 of its size, less
    // than 8 * 2^-53 of the sum of the products' sizes together.
    const double size = std::abs(u[j] * v[k]) + std::abs(u[k] * v[j]);
    if (std::abs(normal[i]) > 0x1p-50 * size) return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    ZeroSum sum;
    sum.add_product(exact_sum(b[j], -a[j]), exact_sum(c[k], -a[k]), 1.0);
    sum.add_product(exact_sum(b[k], -a[k]), exact_sum(c[j], -a[j]), -1.0);
    if (!sum.is_zero()) return false;
  }
  return true;
}

std::string_view name(DefectKind kind) {
  constexpr std::array<std::string_view, kDefectKinds> kNames{"index out of range",
                                                              "vertex not finite",
                                                              "duplicate vertex",
                                                              "degenerate triangle",
                                                              "open edge",
                                                              "non-manifold edge",
                                                              "inconsistently oriented edge",
                                                              "non-manifold vertex",
                                                              "inward component",
                                                              "self-intersection"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool MeshReport::ok() const {
  return std::all_of(counts.begin(), counts.end(), [](std::size_t n) { return n == 0; });
}

MeshReport check(const TriangleMesh& mesh, const CheckOptions& options) {
  return Checker(mesh, options).run();
}

std::vector<PartReport> check(const Model& model, const CheckOptions& options) {
  std::vector<PartReport> reports;
  for (const MeshPart& part : model.parts) {
    reports.push_back({part.name, check(part.mesh, options)});
  }
  return reports;
}

TriangleMesh rounded_to_float(const TriangleMesh& mesh) {
  TriangleMesh rounded = mesh;
  for (Vec3d& p : rounded.positions) p = Vec3d(Vec3<float>(p));
  return rounded;
}

}  // namespace cs2mesh
