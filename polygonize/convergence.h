// How fast, how fine and how far off: a ladder of tolerances climbed with each of several meshers.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/field/compile.h"
#include "libfield/field/counted_surface.h"
#include "polygonize/mesher.h"
#include "polygonize/metrology.h"
#include "polygonize/power_fit.h"

namespace cs2mesh {

struct LadderOptions {
  std::vector<double> tolerances;      ///< scene units, > 0; in the order of the runs
  std::vector<const Mesher*> meshers;  ///< each climbs the whole ladder
  std::size_t samples = 200'000;       ///< each way, see CompareOptions
  std::size_t certified_rays = 2'000;  ///< see CompareOptions
  /// Seconds of meshing after which a run is cut off.
  double time_limit = std::numeric_limits<double>::infinity();
  Progress* progress = nullptr;
};

enum class RunOutcome {
  reached,  ///< a mesh within the tolerance, as its mesher says and as measured
  missed,   ///< a mesh that is off by more
  cut_off,  ///< no mesh in the time that there was
  failed,   ///< no mesh; the remark says why
};
std::string_view name(RunOutcome outcome);

/// One mesher at one tolerance: a row of the table. Lengths in scene units.
struct LadderRun {
  std::string mesher;
  double tolerance = 0.0;
  RunOutcome outcome = RunOutcome::failed;
  std::string remark;  ///< why it is not `reached`
  /// Wall-clock seconds of meshing all parts, compilation left out: the shortest of `timings` runs
  /// of the same, since short ones are repeated. Until it was given up where there is no mesh.
  double seconds = 0.0;
  int timings = 0;
  /// Seconds that all threads together computed in the shortest: what other programs on the machine
  /// take from `seconds` they do not take from these.
  double cpu_seconds = 0.0;
  double measure_seconds = 0.0;
  /// The most memory resident in the process while it meshed, bytes; see MemoryWatch.
  std::uint64_t peak_memory = 0;
  bool own_memory = false;  ///< whether it is of this run alone

  // Where there is a mesh:
  std::size_t vertices = 0, triangles = 0;
  Evaluations evaluations;  ///< all that meshing asked of F
  double estimate = 0.0;    ///< of the distance, by the mesher itself
  MeasuredError error;
  /// How much the largest distance changes with another seed and half of the samples: how far it is
  /// to be trusted.
  double spread = 0.0;

  bool has_mesh() const { return outcome == RunOutcome::reached || outcome == RunOutcome::missed; }
};

/// Meshes every part of the scene with one mesher to one tolerance and measures the mesh both ways
/// (see compare()). The scene is compiled anew for each timing, so that no run profits from what
/// the run before has cached; `compiled`, which it is measured against, is that of the scene,
/// clipped. `model`, if not null, receives the mesh, parts without triangles included. A mesher
/// that fails or runs out of memory is an outcome. Errors: Failure::interrupted.
Result<LadderRun> run_rung(const Scene& scene, const CompiledScene& compiled, const Mesher& mesher,
                           double tolerance, const LadderOptions& options, Model* model = nullptr);

/// What is told of each run as soon as it is over. The mesh has no parts unless run.has_mesh(), and
/// is the visitor's to change or take.
using RunVisitor = std::function<void(const LadderRun& run, Model& model)>;

/// All runs, mesher by mesher. Meshes are not kept. Errors: Failure::interrupted.
Result<std::vector<LadderRun>> climb_ladder(const Scene& scene, const CompiledScene& compiled,
                                            const LadderOptions& options,
                                            const RunVisitor& visit = {});

/// The fitted orders of one mesher, over its runs with a mesh; empty where their costs are too
/// alike to tell. On a smooth surface a mesh that suits it has exponents of -1 against triangles: a
/// distance of the second order in the size of a triangle.
struct MesherOrders {
  std::string mesher;
  std::optional<PowerFit> max_by_triangles, rms_by_triangles, max_by_seconds;
};
/// In the order in which the meshers first appear.
std::vector<MesherOrders> fit_orders(std::span<const LadderRun> runs);

/// What a mesh may cost.
enum class RunCost { seconds, triangles };
double cost_of(const LadderRun& run, RunCost cost);
/// Which runs are on the Pareto front of largest distance and cost, over all meshers together.
std::vector<bool> pareto_runs(std::span<const LadderRun> runs, RunCost cost);

}  // namespace cs2mesh
