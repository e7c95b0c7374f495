// One method, one scene, one size: meshed and measured in a process of its own, so that time runs
// out for one row and not for the table, and memory is that of the row alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "libfield/field/counted_surface.h"
#include "tests/bench/mesh_methods.h"

namespace cs2mesh::bench {

struct Subject {
  std::string name;
  std::string path;  ///< of the scene; its first part is meshed
  std::string text;  ///< the scene itself, where there is no path
};

/// What a table has to know of a scene before anything is meshed.
struct SubjectFacts {
  bool known = false;
  std::uint64_t primitives = 0;
  double diagonal = 0.0;  ///< of the scene, the unit of relative tolerances
  double volume = 0.0;    ///< of the bounds of the surface
  double compile_seconds = 0.0, compile_cpu_seconds = 0.0;
};
SubjectFacts facts_of(const Subject& subject);

struct TrialOptions {
  int threads = 1;
  double most_seconds =
      60.0;  ///< of meshing: of all threads together, and ten times that by the clock
  double most_measure_seconds = 600.0;
  std::size_t samples = 0;  ///< each way; 0: not measured
};

enum class TrialState { meshed, measured, empty, cut_off, not_measured, failed };

struct Trial {
  TrialState state = TrialState::failed;
  double size = 0.0;
  double seconds = 0.0, cpu_seconds = 0.0;  ///< of meshing, compilation left out
  double compile_cpu_seconds = 0.0;
  std::uint64_t vertices = 0, triangles = 0;
  double mesh_to_surface = 0.0, surface_to_mesh = 0.0;
  Evaluations evaluations;
  std::uint64_t peak_memory = 0;  ///< of the whole process until the mesh was there

  double error() const {
    return mesh_to_surface > surface_to_mesh ? mesh_to_surface : surface_to_mesh;
  }
};

/// Never throws or ends the program, whatever the method does: it then failed.
Trial run_trial(const Subject& subject, const MeshMethod& method, double size,
                const TrialOptions& options);

}  // namespace cs2mesh::bench
