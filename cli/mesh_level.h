// One mesh of the scene at one tolerance, ready to be written: what the command line asks for, or a
// coarser level of detail of it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/certify_parts.h"
#include "cli/mesh_parts.h"

namespace cs2mesh {

/// What all levels of a run have in common.
struct MeshRun {
  const MeshRequest& request;
  const Scene& scene;
  const CompiledScene& exact;     ///< its surfaces do not count
  const CompiledScene& compiled;  ///< the same, counting
  Stopwatch& watch;
  Console& console;
};

struct MeshLevel {
  double tolerance = 0.0;  ///< scene units
  std::vector<std::string> outputs;
  MeshedScene meshed;
  LeftOut left_out;
  std::vector<PartReport> checked;
  std::vector<PartCertificate> certificates;  ///< of level 0 alone
  std::optional<MeasuredError> measured;      ///< if that was asked for
};

/// Meshes all parts and unites them if that was asked for; `look`, if there is one, is shown the
/// parts before that and may change their meshes.
MeshedScene mesh_united(const MeshRun& run, const Fineness& fineness,
                        const std::function<void(MeshedScene&)>& look = {});

/// Meshes, certifies, unites, measures and checks, as far as that was asked for. What is off when
/// it is measured is meshed again, finer. `report` is delivered where a certificate is refused.
/// Throws Exit, everything having been said, where anything fails.
MeshLevel mesh_first_level(const MeshRun& run, const Fineness& fineness, const Json& report);

/// The same of what is meshed already, without certificates; fineness.budgeted holds.
MeshLevel level_of(const MeshRun& run, const Fineness& fineness, MeshedScene united);

/// A level of detail to four times the tolerance of the one before, also without certificates.
MeshLevel mesh_coarser_level(const MeshRun& run, Fineness fineness, int number,
                             const MeshLevel& before);

/// The cells, of all parts, that may hide what is thinner than --min-feature; none where a part was
/// meshed without proofs.
std::optional<std::size_t> unresolved_cells(const MeshLevel& level);

/// Adds to the report what is to be said of a level: error, counts, parts, certificates.
void add_level(Json& report, const MeshLevel& level, const MeshRequest& request);

}  // namespace cs2mesh
