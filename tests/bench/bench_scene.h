// What benchmarks of one scene begin with.
#pragma once

#include <cstdio>
#include <ctime>

#include "libfield/art/read_art.h"
#include "libfield/field/compile.h"

namespace cs2mesh::bench {

inline double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The scene in a file; what is wrong with it goes to standard error.
inline Result<CompiledScene> compile_file(const char* path) {
  const Result<Scene> scene = read_art(path);
  Result<CompiledScene> compiled =
      scene ? compile(*scene) : Result<CompiledScene>::failure(scene.diagnostics());
  if (!compiled) {
    std::fprintf(stderr, "%s\n", to_string(compiled.diagnostics().front()).c_str());
  }
  return compiled;
}

}  // namespace cs2mesh::bench
