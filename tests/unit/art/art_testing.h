// Shared by the tests of the reader.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "libfield/art/read_art.h"

namespace cs2mesh {

/// All diagnostics, one a line.
inline std::string lines_of(const Result<Scene>& scene) {
  std::string lines;
  for (const Diagnostic& d : scene.diagnostics()) lines += to_string(d) + "\n";
  return lines;
}

/// The scene of a text that must be right.
inline Scene scene_of(std::string_view text, const ReadArtOptions& options = {}) {
  Result<Scene> scene = parse_art(text, "test.art", options);
  EXPECT_TRUE(scene) << lines_of(scene);
  return scene ? *std::move(scene) : Scene{};
}

/// What is said about a text.
inline std::string said_of(std::string_view text, const ReadArtOptions& options = {}) {
  return lines_of(parse_art(text, "test.art", options));
}

}  // namespace cs2mesh
