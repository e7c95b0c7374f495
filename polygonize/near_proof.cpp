#include "polygonize/near_proof.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/bent_triangle.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The middle of an edge, known by its vertices, the lesser first; a vertex by itself twice.
using Place = std::pair<Index, Index>;

/// The corners of a triangle, and the middles of the edges opposite to them.
std::array<Place, 6> places_of(const std::array<Index, 3>& t) {
  std::array<Place, 6> places;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index a = t[(k + 1) % 3], b = t[(k + 2) % 3];
    places[k] = {t[k], t[k]};
    places[k + 3] = {std::min(a, b), std::max(a, b)};
  }
  return places;
}

/// The four parts of a triangle, by the numbers of places_of().
constexpr std::array<std::array<std::size_t, 3>, 4> kQuarters{
    {{0, 5, 4}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}}};

/// F at places above the mesh, or below.
class Layer {
 public:
  void want(const Place& place) { places_.push_back(place); }
  void settle() {
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    jets.resize(places_.size());
  }
  std::span<const Place> places() const { return places_; }
  const Jet& at(const Place& place) const {
    const auto found = std::lower_bound(places_.begin(), places_.end(), place);
    return jets[static_cast<std::size_t>(found - places_.begin())];
  }

  std::vector<Jet> jets;  ///< by place; of the outer layer without gradients

 private:
  std::vector<Place> places_;  ///< in ascending order
};

/// A triangle that is not proven: which of its layers are, and what bounds F between them.
struct Open {
  std::size_t number = 0;
  bool outer = true, inner = true;  ///< open
  HullBound bound{};
};

class Prover {
 public:
  Prover(const ImplicitSurface& surface, const TriangleMesh& mesh,
         std::span<const std::size_t> triangles, std::span<const Vec3d> directions, double distance)
      : mesh_(mesh), triangles_(triangles), directions_(directions), distance_(distance) {
    Aabb box;
    for (const std::size_t t : triangles) {
      for (const Index v : mesh.triangles[t]) {
        box.include(point({v, v}, true));
        box.include(point({v, v}, false));
      }
    }
    part_ = surface.restrict_to(box);
  }

  std::vector<bool> run() {
    std::vector<bool> proven(triangles_.size(), true);
    std::vector<Open> open(triangles_.size());
    for (std::size_t i = 0; i < open.size(); ++i) open[i].number = i;
    look_at(open, 0);
    std::erase_if(open, [&](Open& o) {
      if (!has_right_signs(o, 0)) return !(proven[o.number] = false);
      bound(o);
      return is_proven(o, {&kWhole, 1});
    });
    look_at(open, 3);
    for (Open& o : open) {
      proven[o.number] = has_right_signs(o, 3) && is_proven(o, kQuarters);
    }
    return proven;
  }

 private:
  static constexpr std::array<std::size_t, 3> kWhole{0, 1, 2};

  std::array<Place, 6> places(const Open& o) const {
    return places_of(mesh_.triangles[triangles_[o.number]]);
  }
  Vec3d point(const Place& place, bool outer) const {
    const auto [a, b] = place;
    return 0.5 * (mesh_.positions[a] + mesh_.positions[b]) +
           (outer ? 0.5 : -0.5) * distance_ * (directions_[a] + directions_[b]);
  }

  /// Asks F at the corners of open layers, or with `first` 3 in the middles of their edges.
  void look_at(std::span<const Open> open, std::size_t first) {
    Layer &outer = outer_[first / 3], &inner = inner_[first / 3];
    for (const Open& o : open) {
      const std::array<Place, 6> all = places(o);
      for (std::size_t k = first; k < first + 3; ++k) {
        if (o.outer) outer.want(all[k]);
        if (o.inner) inner.want(all[k]);
      }
    }
    outer.settle();
    inner.settle();
    std::vector<Vec3d> points;
    for (const Place& place : inner.places()) points.push_back(point(place, false));
    part_->jets(points, inner.jets);
    points.clear();
    for (const Place& place : outer.places()) points.push_back(point(place, true));
    std::vector<double> values(points.size());
    part_->values(points, values);
    for (std::size_t i = 0; i < values.size(); ++i) outer.jets[i].value = values[i];
  }

  /// Where a sign is wrong, nothing can be proven.
  bool has_right_signs(const Open& o, std::size_t first) const {
    const std::array<Place, 6> all = places(o);
    for (std::size_t k = first; k < first + 3; ++k) {
      if (o.outer && !(outer_[k / 3].at(all[k]).value < 0)) return false;
      if (o.inner && !(inner_[k / 3].at(all[k]).value > 0)) return false;
    }
    return true;
  }

  void bound(Open& o) const {
    const std::array<Place, 6> all = places(o);
    std::array<Vec3d, 6> hull;
    for (std::size_t k = 0; k < 3; ++k) {
      hull[k] = point(all[k], true);
      hull[k + 3] = point(all[k], false);
    }
    o.bound = part_->hull_bound(hull, {});
  }

  /// Whether no layer is open any more after these parts of the triangle have been looked at.
  bool is_proven(Open& o, std::span<const std::array<std::size_t, 3>> parts) const {
    if (!(o.bound.bend < HullBound::kInfinity)) return false;
    const std::array<Place, 6> all = places(o);
    const auto each = [&](const auto& holds) {
      return std::all_of(parts.begin(), parts.end(), holds);
    };
    o.outer = o.outer && !each([&](const auto& part) { return is_outside(o, all, part); });
    o.inner = o.inner && !each([&](const auto& part) { return is_inside(o, all, part); });
    return !o.outer && !o.inner;
  }

  bool is_outside(const Open& o, const std::array<Place, 6>& all,
                  const std::array<std::size_t, 3>& part) const {
    Corners corners;
    std::array<double, 3> high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Place& place = all[part[k]];
      corners[k] = point(place, true);
      high[k] = o.bound.high(outer_[part[k] / 3].at(place).value);
    }
    return highest_over(corners, high, o.bound.bend) < 0;
  }

  bool is_inside(const Open& o, const std::array<Place, 6>& all,
                 const std::array<std::size_t, 3>& part) const {
    std::array<Tangent, 3> tangents;
    for (std::size_t k = 0; k < 3; ++k) {
      const Place& place = all[part[k]];
      const Jet& jet = inner_[part[k] / 3].at(place);
      tangents[k] = {point(place, false), o.bound.low(jet.value), o.bound.gradient(jet)};
    }
    return lowest_over(tangents, o.bound.bend) > 0;
  }

  const TriangleMesh& mesh_;
  std::span<const std::size_t> triangles_;
  std::span<const Vec3d> directions_;
  double distance_;
  std::unique_ptr<ImplicitSurface> part_;
  std::array<Layer, 2> outer_, inner_;  ///< at corners, and in the middles of edges
};

}  // namespace

std::vector<bool> proven_near(const ImplicitSurface& surface, const TriangleMesh& mesh,
                              std::span<const std::size_t> triangles,
                              std::span<const Vec3d> directions, double distance) {
  require(directions.size() == mesh.positions.size(), "proven_near: one direction a vertex");
  require(distance > 0, "proven_near: the distance must be positive");
  if (triangles.empty()) return {};
  return Prover(surface, mesh, triangles, directions, distance).run();
}

std::vector<Vec3d> ways_out(const TriangleMesh& mesh) {
  std::vector<Vec3d> ways(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& corner = mesh.positions[t[k]];
      const Vec3d u = mesh.positions[t[(k + 1) % 3]] - corner;
      const Vec3d v = mesh.positions[t[(k + 2) % 3]] - corner;
      const double weight = squared_norm(u) * squared_norm(v);
      if (weight > 0) ways[t[k]] += cross(u, v) / weight;
    }
  }
  for (Vec3d& way : ways) {
    const double length = norm(way);
    way = length > 0 ? way / length : Vec3d{};
  }
  return ways;
}

}  // namespace cs2mesh
