#include "libfield/field/compile.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "libfield/base/check.h"
#include "libfield/field/field.h"
#include "libfield/field/make_term.h"
#include "libfield/solid/make_solid.h"

namespace cs2mesh {
namespace {

/// A hard solid is of one material throughout.
class OneMaterial final : public MaterialBlend {
 public:
  explicit OneMaterial(int material) : material_(material) {}
  void shares(const Vec3d& /*point*/, std::vector<MaterialShare>& shares) const override {
    shares.assign(1, {material_, 1.0});
  }

 private:
  int material_;
};

/// The blend groups of elements: that of the nearest object around each with a `blend` line.
class BlendGroups {
 public:
  explicit BlendGroups(const Scene& scene) : names_{"soft"}, groups_(scene.objects.size() + 1, 0) {
    std::map<std::string, std::size_t> known{{"soft", 0}};
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Object& object = scene.objects[i];
      std::size_t& group = groups_[i + 1];
      group = groups_[static_cast<std::size_t>(object.parent + 1)];
      if (!object.blend) continue;
      const bool nameless = object.blend->empty();
      const std::string name = nameless ? "#" + std::to_string(++nameless_) : *object.blend;
      group = known.try_emplace(name, names_.size()).first->second;
      if (group == names_.size()) names_.push_back(name);
    }
  }
  std::size_t count() const { return names_.size(); }
  const std::string& name(std::size_t group) const { return names_[group]; }
  std::size_t of(const Element& element) const {
    return groups_[static_cast<std::size_t>(element.object + 1)];
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::size_t> groups_;  ///< by object index + 1
  int nameless_ = 0;
};

/// Squares of coordinates up to here, and products of two of those, stay finite.
constexpr double kLargestCoordinate = 1e100;

bool reaches_beyond(const Aabb& box, double limit) {
  const auto beyond = [limit](double x) { return std::isfinite(x) && std::abs(x) > limit; };
  return beyond(box.min.x) || beyond(box.min.y) || beyond(box.min.z) || beyond(box.max.x) ||
         beyond(box.max.y) || beyond(box.max.z);
}

/// So many elements are made into terms side by side before they are taken over one by one.
constexpr std::size_t kWave = 8192, kGrain = 256;

struct Group {
  std::vector<Term> terms;
  SourceLocation where;
  double thinnest = 0.0;
  bool creased = false;
  std::size_t elements = 0;
};

class Compiler {
 public:
  Compiler(const Scene& scene, const CompileOptions& options)
      : scene_(scene), options_(options), blends_(scene), groups_(blends_.count()) {}

  Result<CompiledScene> run() {
    const std::span elements(scene_.elements);
    reserve_terms();
    for (std::size_t first = 0; first < elements.size(); first += kWave) {
      add_wave(elements.subspan(first, std::min(kWave, elements.size() - first)));
    }
    if (!errors_.empty()) return Result<CompiledScene>::failure(std::move(errors_));
    for (const std::size_t group : group_order_) finish(blends_.name(group), groups_[group]);
    for (Part& solid : solids_) compiled_.parts.push_back(std::move(solid));
    if (compiled_.parts.empty()) {
      return error_at({scene_.file, 0, 0},
                      "the scene has no surface, expected at least one element whose strength is "
                      "not 0");
    }
    return {std::move(compiled_), std::move(notes_)};
  }

 private:
  bool is_summed(const Element& element) const { return scene_.soft && is_soft(scene_, element); }

  /// Terms are large: a vector of them that grew would write each more than once.
  void reserve_terms() {
    std::vector<std::size_t> counts(groups_.size(), 0);
    for (const Element& element : scene_.elements) {
      if (is_summed(element)) ++counts[blends_.of(element)];
    }
    for (std::size_t i = 0; i < groups_.size(); ++i) groups_[i].terms.reserve(counts[i]);
  }

  void add_wave(std::span<const Element> wave) {
    std::vector<std::optional<Result<MadeTerms>>> made(wave.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, wave.size(), kGrain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i < range.end(); ++i) {
                          if (is_summed(wave[i])) made[i] = make_terms(scene_, wave[i]);
                        }
                      });
    for (std::size_t i = 0; i < wave.size(); ++i) {
      if (made[i]) {
        add_soft(wave[i], *made[i]);
      } else {
        add_hard(wave[i]);
      }
    }
  }

  void add_soft(const Element& element, Result<MadeTerms>& made) {
    if (!keep_remarks(made) || made->terms.empty()) return;
    const std::size_t index = blends_.of(element);
    Group& group = groups_[index];
    if (group.elements == 0) {
      group_order_.push_back(index);
      group.where = element.where;
      group.thinnest = made->radius;
    }
    if (made->radius > 0) group.thinnest = std::min(group.thinnest, made->radius);
    ++group.elements;
    for (Term& term : made->terms) {
      include(skeleton_box(term), made->radius, element.where);
      for (const StrengthProfile& profile : term.profiles) {
        group.creased = group.creased || has_corners(profile);
      }
      group.terms.push_back(std::move(term));
    }
  }

  void add_hard(const Element& element) {
    Result<MadeSolid> made = make_solid(scene_, element, is_soft(scene_, element));
    if (!keep_remarks(made)) return;
    Part part;
    part.name = std::string(name_of(element.kind)) + " " + std::to_string(element.where.line);
    const std::size_t twins = ++hard_names_[part.name];
    if (twins > 1) part.name += "." + std::to_string(twins);
    part.soft = false;
    part.where = element.where;
    part.surface = made->surface;
    part.materials = std::make_shared<OneMaterial>(element.material);
    part.thinnest_radius = made->radius;
    part.creased = made->creased;
    part.primitive_count = 1;
    include(part.surface->bounds(), 0.0, element.where);
    solids_.push_back(std::move(part));
  }

  void finish(const std::string& name, Group& group) {
    Part part;
    part.name = name;
    part.where = group.where;
    part.thinnest_radius = group.thinnest;
    part.creased = group.creased;
    part.primitive_count = group.elements;
    auto field = std::make_shared<Field>(std::move(group.terms), options_.error_budget);
    part.surface = field;
    part.materials = field;
    compiled_.parts.push_back(std::move(part));
  }

  /// Grows the extent; unbounded sides count up to `mesh bounds`.
  void include(Aabb box, double radius, const SourceLocation& where) {
    box = box.grown(radius);
    if (reaches_beyond(box, kLargestCoordinate)) {
      keep_remarks(Result<Aabb>(
          error_at(where, "the element reaches beyond 1e100, expected smaller coordinates")));
      return;
    }
    if (!box.finite()) {
      if (!scene_.mesh.bounds) return;
      box = {max(box.min, scene_.mesh.bounds->min), min(box.max, scene_.mesh.bounds->max)};
    }
    if (!box.empty()) compiled_.extent.include(box);
  }

  template <class T>
  bool keep_remarks(const Result<T>& result) {
    auto& kept = result ? notes_ : errors_;
    constexpr std::size_t kMostErrors = 20;
    for (const Diagnostic& d : result.diagnostics()) {
      if (result || kept.size() < kMostErrors) kept.push_back(d);
    }
    return static_cast<bool>(result);
  }

  const Scene& scene_;
  const CompileOptions& options_;
  BlendGroups blends_;
  std::vector<Group> groups_;
  std::vector<std::size_t> group_order_;
  std::map<std::string, std::size_t> hard_names_;
  std::vector<Part> solids_;
  CompiledScene compiled_;
  std::vector<Diagnostic> notes_, errors_;
};

}  // namespace

void MaterialBlend::blend(std::span<const Vec3d> points, std::span<const Vec3d> property,
                          std::span<Vec3d> out) const {
  require(points.size() == out.size(), "one result a point");
  std::vector<MaterialShare> at_point;
  for (std::size_t i = 0; i < points.size(); ++i) {
    shares(points[i], at_point);
    out[i] = {};
    for (const MaterialShare& share : at_point) {
      const auto material = static_cast<std::size_t>(share.material);
      require(material < property.size(), "a share names a material without the property");
      out[i] += share.share * property[material];
    }
  }
}

Result<CompiledScene> compile(const Scene& scene, const CompileOptions& options) {
  return Compiler(scene, options).run();
}

}  // namespace cs2mesh
