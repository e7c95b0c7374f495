// What must hold for any text given to the reader; used by the fuzzer and by the corpus test.
#pragma once

#include <string_view>

#include "libfield/art/print_art.h"
#include "libfield/art/read_art.h"

namespace cs2mesh {

/// Reads `text` (its first 64 KiB) without touching any file. True if the result is sound: errors
/// where there is no scene, at most 20 of them, and a scene that prints as a scene of the same
/// size.
inline bool fuzz_case_holds(std::string_view text) {
  constexpr std::size_t kMaxBytes = 65536;
  ReadArtOptions options;
  options.allow_read = false;
  options.max_elements = 20'000;
  const Result<Scene> scene = parse_art(text.substr(0, kMaxBytes), "fuzz.art", options);
  if (!scene) return !scene.diagnostics().empty() && scene.diagnostics().size() <= 20;
  const Result<Scene> again = parse_art(print_art(*scene), "printed.art", options);
  return again && again->elements.size() == scene->elements.size() &&
         again->objects.size() == scene->objects.size();
}

}  // namespace cs2mesh
