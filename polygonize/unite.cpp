#include "polygonize/unite.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "libfield/base/box_tree.h"
#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/corefinement.h"
#include "polygonize/disjoint_sets.h"
#include "polygonize/part_contacts.h"
#include "polygonize/sliver_removal.h"

namespace cs2mesh {
namespace {

/// Shares of the tolerance: heights of slivers, and by how much a solid is moved.
constexpr double kFlattest = 1.0 / 64, kFlattestAtLast = 1.0 / 8;
constexpr double kShifts[] = {0.0, 1.0 / 32, 1.0 / 16};
/// So many vertices at defects are not those of a few slivers: sheets lie on each other.
constexpr std::size_t kManyWrong = 600;
/// Rounding to float32 moves a point by up to sqrt(3) 2^-25 of its largest coordinate; triangles
/// this many times as high survive that, also in a turned frame.
constexpr double kRoundingsHigh = 16;

double largest_coordinate(const TriangleMesh& mesh) {
  const Aabb box = bounds(mesh);
  const Vec3d m = max(max(box.max, -box.max), max(box.min, -box.min));
  return std::max({m.x, m.y, m.z});
}

/// A mesh moved by `distance` towards another, so that solids that touch overlap, and somewhat
/// askew, so that faces that coincide part, as those along the axes do.
TriangleMesh shifted(TriangleMesh mesh, const TriangleMesh& other, double distance) {
  Vec3d way = bounds(other).center() - bounds(mesh).center();
  const double length = norm(way);
  if (length > 0) way = way / length;
  const Vec3d askew{0.23, 0.19, 0.17};
  for (std::size_t axis = 0; axis < 3; ++axis) way[axis] += std::copysign(askew[axis], way[axis]);
  for (Vec3d& p : mesh.positions) p += distance * normalized(way);
  return mesh;
}

/// The vertices at defects.
std::vector<TriangleMesh::Index> defective(const TriangleMesh& mesh) {
  std::vector<TriangleMesh::Index> vertices;
  for (const Defect& defect : check(mesh).defects) {
    for (const auto t : defect.triangles) {
      vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
  }
  return vertices;
}

/// How well an attempt turned out; the higher, the better.
enum class Soundness { broken, as_doubles, as_floats };

struct Attempt {
  Soundness soundness = Soundness::broken;
  TaggedMesh mesh;
};

class Uniter {
 public:
  Uniter(Model model, const UniteOptions& options) : model_(std::move(model)), options_(options) {}

  Result<Model> run() {
    const std::vector<PartContact> contacts = find_contacts(model_);
    remove_swallowed(contacts);
    DisjointSets groups(model_.parts.size());
    for (const PartContact& contact : contacts) {
      groups.join(static_cast<std::uint32_t>(contact.a), static_cast<std::uint32_t>(contact.b));
    }
    std::vector<std::vector<std::size_t>> members(model_.parts.size());
    for (std::uint32_t i = 0; i < members.size(); ++i) {
      if (!model_.parts[i].mesh.empty()) members[groups.root(i)].push_back(i);
    }
    Model united;
    for (const auto& group : members) {
      if (group.empty()) continue;
      if (group.size() == 1) {
        united.parts.push_back(std::move(model_.parts[group[0]]));
        continue;
      }
      std::optional<TaggedMesh> mesh = unite_all(group);
      if (!mesh) return Result<Model>::failure(std::move(remarks_));
      united.parts.push_back(finished(std::move(*mesh), group));
    }
    return {std::move(united), std::move(remarks_)};
  }

 private:
  SourceLocation where(std::size_t part) const {
    return part < options_.where.size() ? options_.where[part] : SourceLocation{};
  }
  std::string quoted(std::size_t part) const { return "'" + model_.parts[part].name + "'"; }

  void remove_swallowed(const std::vector<PartContact>& contacts) {
    std::set<std::pair<std::size_t, std::size_t>> meeting;
    for (const PartContact& contact : contacts) {
      meeting.emplace(contact.a, contact.b);
      meeting.emplace(contact.b, contact.a);
    }
    std::vector<Aabb> boxes;
    for (const MeshPart& part : model_.parts) boxes.push_back(bounds(part.mesh));
    const BoxTree tree(boxes);
    // All are looked at before any is changed: a ball that reaches from the hollow of a shell into
    // the shell disappears, and takes the hollow with it.
    std::map<std::size_t, TriangleMesh> rest;
    for (std::size_t a = 0; a < model_.parts.size(); ++a) {
      std::vector<std::uint32_t> near;
      tree.overlapping(boxes[a], near);
      std::sort(near.begin(), near.end());
      TriangleMesh mesh = model_.parts[a].mesh;
      bool changed = false;
      for (const std::size_t b : near) {
        if (a == b || mesh.empty() || meeting.count({a, b}) > 0) continue;
        changed |= remove_components_inside(mesh, model_.parts[b].mesh);
        if (mesh.empty()) {
          remarks_.push_back(
              {Severity::note, Failure::none, where(a),
               "part " + quoted(a) + " lies inside of part " + quoted(b) + " and disappears"});
        }
      }
      if (changed) rest[a] = std::move(mesh);
    }
    for (auto& [a, mesh] : rest) model_.parts[a].mesh = std::move(mesh);
  }

  TaggedMesh tagged(std::size_t part) {
    TriangleMesh mesh = std::move(model_.parts[part].mesh);
    std::vector<std::uint32_t> tags(mesh.triangles.size(), static_cast<std::uint32_t>(part));
    return {std::move(mesh), std::move(tags)};
  }

  /// The union of parts: that of the unions of either half of them.
  std::optional<TaggedMesh> unite_all(std::span<const std::size_t> group) {
    if (group.size() == 1) return tagged(group[0]);
    const std::size_t half = group.size() / 2;
    const std::optional<TaggedMesh> a = unite_all(group.first(half));
    if (!a) return std::nullopt;
    const std::optional<TaggedMesh> b = unite_all(group.subspan(half));
    if (!b) return std::nullopt;
    return unite_two(*a, *b);
  }

  std::optional<TaggedMesh> unite_two(const TaggedMesh& a, const TaggedMesh& b) {
    Attempt best;
    std::optional<CorefinedUnion::Outcome> outcome;  // of the first attempt
    for (const double shift : kShifts) {
      if (cancelled(options_.progress)) {
        remarks_.push_back(error_at({}, "interrupted", Failure::interrupted));
        return std::nullopt;
      }
      CorefinedUnion result =
          shift > 0
              ? corefined_union(a, {shifted(b.mesh, a.mesh, shift * options_.tolerance), b.tags})
              : corefined_union(a, b);
      if (!outcome) outcome = result.outcome;
      if (result.outcome == CorefinedUnion::Outcome::no_cgal) break;
      if (result.outcome != CorefinedUnion::Outcome::united) continue;
      Attempt attempt = cleaned(result);
      if (attempt.soundness > best.soundness) best = std::move(attempt);
      if (best.soundness == Soundness::as_floats) break;
    }
    if (best.soundness != Soundness::broken) return std::move(best.mesh);
    give_up(a, b, *outcome);
    return std::nullopt;
  }

  /// Removes slivers along the crease: at first those that make for a fine mesh, or else, where
  /// sheets are that near to each other, no more than must be, or flatter and flatter ones about
  /// what is still wrong.
  Attempt cleaned(const CorefinedUnion& united) const {
    const double rounding = std::sqrt(3.0) * 0x1p-25 * largest_coordinate(united.mesh.mesh);
    const double most = kFlattestAtLast * options_.tolerance;
    const double least = std::min(kRoundingsHigh * rounding, most);
    const double fine = std::max(least, kFlattest * options_.tolerance);
    Attempt best;
    for (const double start : {fine, least}) {
      TaggedMesh mesh = united.mesh;
      std::vector<char> is_open = united.is_fresh;
      for (double height = start; height <= most; height *= start < fine ? 4 : 2) {
        remove_slivers(mesh, is_open, height);
        const std::vector<TriangleMesh::Index> wrong = defective(rounded_to_float(mesh.mesh));
        const bool open_question = wrong.empty() || best.soundness == Soundness::broken;
        const bool sound = open_question && defective(mesh.mesh).empty();
        if (wrong.empty() && sound) return {Soundness::as_floats, std::move(mesh)};
        if (sound && best.soundness == Soundness::broken) best = {Soundness::as_doubles, mesh};
        if (height == start && start == fine && fine > least && wrong.size() > kManyWrong) break;
        for (const auto v : wrong) is_open[v] = 1;
      }
    }
    return best;
  }

  void give_up(const TaggedMesh& a, const TaggedMesh& b, CorefinedUnion::Outcome outcome) {
    const std::size_t one = a.tags.front(), other = b.tags.front();
    std::string text = "parts " + quoted(one) + " and " + quoted(other) + " meet, but ";
    Failure failure = Failure::check_failed;
    switch (outcome) {
      case CorefinedUnion::Outcome::no_cgal:
        text += "this build has no CGAL to unite them";
        failure = Failure::unmeshable;
        break;
      case CorefinedUnion::Outcome::not_manifold:
        text += "touch so that their union has no manifold surface";
        break;
      case CorefinedUnion::Outcome::broken_input:
        text += "one of them intersects itself where they do";
        break;
      case CorefinedUnion::Outcome::united:
        text += "their union fails its check: they may coincide, or nearly so";
    }
    Aabb both = bounds(a.mesh);
    const Aabb reach = bounds(b.mesh);
    both = {max(both.min, reach.min), min(both.max, reach.max)};
    char place[128];
    const Vec3d c = both.center();
    std::snprintf(place, sizeof place, ", about (%.6g, %.6g, %.6g)", c.x, c.y, c.z);
    remarks_.push_back(error_at(where(other), text + place, failure));
  }

  /// With triangles by their sources.
  MeshPart finished(TaggedMesh tagged, const std::vector<std::size_t>& group) const {
    MeshPart part;
    part.name = model_.parts[group[0]].name + " + " + model_.parts[group[1]].name;
    if (group.size() > 2) {
      part.name = model_.parts[group[0]].name + " + " + std::to_string(group.size() - 1) + " more";
    }
    for (const std::size_t i : group) part.sources.push_back(model_.parts[i].name);
    std::vector<std::uint32_t> order(tagged.tags.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t s, std::uint32_t t) {
      return tagged.tags[s] < tagged.tags[t];
    });
    part.mesh.positions = std::move(tagged.mesh.positions);
    for (const std::uint32_t t : order) {
      const auto source = std::lower_bound(group.begin(), group.end(), tagged.tags[t]);
      part.mesh.triangles.push_back(tagged.mesh.triangles[t]);
      part.source_of.push_back(static_cast<std::uint32_t>(source - group.begin()));
    }
    return part;
  }

  Model model_;
  const UniteOptions& options_;
  std::vector<Diagnostic> remarks_;
};

}  // namespace

bool can_unite() {
  return has_corefinement();
}

Result<Model> unite(Model model, const UniteOptions& options) {
  require(options.tolerance > 0, "unite: the tolerance must be positive");
  if (model.parts.size() < 2) return model;
  return Uniter(std::move(model), options).run();
}

}  // namespace cs2mesh
