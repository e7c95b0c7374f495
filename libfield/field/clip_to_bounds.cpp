// `mesh bounds`: each part intersected with a box; its faces close what leaves it.
#include "libfield/field/compile.h"
#include "libfield/solid/combination.h"
#include "libfield/solid/half_space.h"

namespace cs2mesh {
namespace {

/// The faces of the box as half-spaces whose functions have slope `slope`.
void append_faces(const Aabb& box, double slope,
                  std::vector<std::shared_ptr<const ImplicitSurface>>& parts) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d normal{};
    normal[axis] = slope;
    parts.push_back(std::make_shared<HalfSpace>(box.max, normal));
    parts.push_back(std::make_shared<HalfSpace>(box.min, -normal));
  }
}

Part clipped(Part part, const Aabb& box) {
  const Aabb own = part.surface->bounds();
  if (own.empty() || box.contains(own)) return part;
  // Comparable slopes keep the two functions comparable where they meet: a field falls from about
  // T to 0 over its radius.
  const double radius = part.thinnest_radius > 0 ? part.thinnest_radius : box.diagonal();
  std::vector<std::shared_ptr<const ImplicitSurface>> parts{part.surface};
  append_faces(box, part.soft ? 1 / radius : 1.0, parts);
  part.surface = std::make_shared<Combination>(CombinationKind::intersection, std::move(parts));
  part.creased = true;
  return part;
}

}  // namespace

Result<CompiledScene> clip_to_bounds(CompiledScene compiled, const Scene& scene) {
  std::vector<Diagnostic> errors;
  for (Part& part : compiled.parts) {
    const Aabb own = part.surface->bounds();
    if (scene.mesh.bounds) {
      part = clipped(std::move(part), *scene.mesh.bounds);
    } else if (!own.empty() && !own.finite()) {
      errors.push_back(error_at(
          part.where,
          "the surface of '" + part.name + "' is unbounded, expected 'mesh bounds' to close it",
          Failure::unmeshable));
    }
  }
  if (!errors.empty()) return Result<CompiledScene>::failure(std::move(errors));
  return compiled;
}

}  // namespace cs2mesh
