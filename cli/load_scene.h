// From a scene file to what verbs work on.
#pragma once

#include "cli/console.h"
#include "cli/json_report.h"
#include "cli/options.h"
#include "libfield/field/compile.h"

namespace cs2mesh {

/// Reads the scene; --bounds replaces the scene's own. Throws Exit after the errors are shown.
Scene read_scene(const SceneOptions& options, Console& console, Stopwatch& watch);

/// Compiles the scene and clips its parts to the bounds, so that each has a bounded surface. Throws
/// Exit after the errors are shown.
CompiledScene bounded_parts(const Scene& scene, Console& console, Stopwatch& watch);

}  // namespace cs2mesh
