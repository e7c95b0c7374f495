// Scene -> parts: each blend group's field and each hard solid as an ImplicitSurface.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// What the surface is made of at a point: material index and share; shares sum to 1.
struct MaterialShare {
  int material = 0;
  double share = 0.0;
};

/// Which materials meet at a point (thesis 4.2.5, equations 4.11 and 4.12).
class MaterialBlend {
 public:
  virtual ~MaterialBlend() = default;
  /// Replaces `shares` by those of the point; never empty afterwards.
  virtual void shares(const Vec3d& point, std::vector<MaterialShare>& shares) const = 0;
  /// A property of the materials at each point (4.12): the sum of property[material] weighted by
  /// the shares. `out` is as long as `points`; `property` has every material of the part.
  virtual void blend(std::span<const Vec3d> points, std::span<const Vec3d> property,
                     std::span<Vec3d> out) const;
};

/// A part of the scene that is meshed on its own.
struct Part {
  std::string name;  ///< "soft", the name of a blend group, or that of a hard solid; unique
  bool soft = true;
  SourceLocation where;  ///< of a hard solid, or of the first element of a blend group
  std::shared_ptr<const ImplicitSurface> surface;
  std::shared_ptr<const MaterialBlend> materials;
  /// The smallest radius in isolation of its elements, scene units; a length scale for sampling.
  double thinnest_radius = 0.0;
  /// F has corners: flat lids, profiles with corners, faces of mesh bounds.
  bool creased = false;
  std::size_t primitive_count = 0;
};

struct CompileOptions {
  /// The most that may be left out of F at any point, in units of T.
  double error_budget = 1e-9;
};

struct CompiledScene {
  std::vector<Part> parts;
  /// Union of the boxes of all primitives, each grown by its R, after transforms (unbounded
  /// primitives are clipped to `mesh bounds`). Its diagonal is the unit of `--tolerance 0.1%`.
  Aabb extent;
};

/// Builds what a mesher needs. Errors (all located in the scene): no surface at all; a soft element
/// without radius and width; a kernel that diverges on its primitive (unmeshable); a flat thing
/// without thickness. Elements of strength 0 are dropped; degenerate primitives become points, with
/// a note. Whether an unbounded part has bounds is not checked here: see clip_to_bounds.
Result<CompiledScene> compile(const Scene& scene, const CompileOptions& options = {});

/// Intersects each part with scene.mesh.bounds, if set. Error (unmeshable, located) if a part is
/// unbounded and there are none.
Result<CompiledScene> clip_to_bounds(CompiledScene compiled, const Scene& scene);

}  // namespace cs2mesh
