// Compiled scene -> meshes, as the command line asks for.
#pragma once

#include <optional>
#include <vector>

#include "cli/mesh_report.h"
#include "cli/mesh_request.h"
#include "libfield/field/compile.h"
#include "polygonize/leave_out.h"
#include "polygonize/mesher.h"
#include "polygonize/metrology.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// How finely a scene is to be meshed, in scene units.
struct Fineness {
  double tolerance = 0.0;
  double cell = 0.0;               ///< 0: what the tolerance needs
  double min_feature = 0.0;        ///< what is thinner may be lost
  bool budgeted = false;           ///< the tolerance is what a number of triangles allows
  const Mesher* mesher = nullptr;  ///< where there is no cell
  bool balance = false;            ///< as of MesherRequest
};
Fineness fineness_of(const MeshRequest& request, const Scene& scene, const CompiledScene& compiled);

/// What is to be said of a part's meshing.
struct PartLog {
  std::string name;
  double cell = 0.0;
  double error = 0.0;  ///< estimated on the mesh
  /// See MesherResult; of several parts together, if all of them know.
  std::optional<std::size_t> unresolved_cells{};
};

struct MeshedScene {
  Model model;               ///< parts that are not empty
  std::vector<PartLog> log;  ///< of each part of the model
  /// Of each part of the model: indices into CompiledScene::parts, one, or one a source of a union.
  std::vector<std::vector<std::size_t>> parts_of;
  std::vector<PartLog> swallowed;  ///< parts that lie inside of others
};

/// One part, with the fineness's mesher; that may end short of the tolerance.
Result<MesherResult> mesh_part(const Part& part, const Fineness& fineness, Console& console);

/// Meshes every part. Throws Exit, everything having been said, where a tolerance is missed or
/// nothing is there to mesh.
MeshedScene mesh_parts(const CompiledScene& compiled, const Scene& scene, const Fineness& fineness,
                       Console& console);

/// Unites the parts that touch. Throws Exit, everything having been said, where that fails.
void unite_parts(MeshedScene& meshed, const CompiledScene& compiled, const Fineness& fineness,
                 Console& console);

/// What of the components the request does not want.
LeaveOutOptions leave_out_options(const MeshRequest& request, const CompiledScene& compiled,
                                  Console& console);

/// Leaves out the components that the request does not want, and says what that was. Throws Exit
/// where nothing is left.
LeftOut leave_out(MeshedScene& meshed, const CompiledScene& compiled, const MeshRequest& request,
                  Console& console);

/// Adds the attributes that the request wants.
void add_attributes(MeshedScene& meshed, const CompiledScene& compiled, const Scene& scene,
                    const MeshRequest& request);

/// The cell that each part would be meshed with first; nothing is meshed.
std::vector<PartLog> plan_parts(const CompiledScene& compiled, const Fineness& fineness);

/// {"small": {"components": ..., "voids": ..., "area": ...}, "enclosed": {...}}
Json to_json(const LeftOut& left_out);

/// {"mesh_to_surface_max": ..., ...}
Json to_json(const MeasuredError& error);

}  // namespace cs2mesh
