// One mesh of the scene at one tolerance, ready to be written: what the command line asks for, or a
// coarser level of detail of it.
#pragma once

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
  Json error;                                 ///< estimated, or measured
};

/// The fineness of that level, where `fineness` is that of level 0: each has four times the
/// tolerance of the one before.
Fineness coarser(Fineness fineness, int number);

/// Meshes all parts, unites, measures and checks them, as far as that was asked for. `report` is
/// delivered where a certificate is refused. Throws Exit, everything having been said, where
/// anything fails.
MeshLevel mesh_level(const MeshRun& run, const Fineness& fineness, int number, const Json& report);

/// Adds to the report what is to be said of a level: error, counts, parts, certificates.
void add_level(Json& report, const MeshLevel& level, const MeshRequest& request);

}  // namespace cs2mesh
