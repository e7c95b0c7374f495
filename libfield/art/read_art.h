// .art text -> Scene.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

struct ReadArtOptions {
  /// Variables that win over the scene's own `var` lines of the same name: name -> value text.
  std::map<std::string, std::string> defines;
  /// Most primitives (also objects, surfaces, textures and variables, each), files nested, bytes of
  /// one file.
  std::size_t max_elements = 10'000'000;
  int max_depth = 128;
  std::size_t max_file_bytes = std::size_t{1} << 30;
  /// Whether `read` may open files; if not, it is an error.
  bool allow_read = true;
};

/// Reads the file and those that it reads. Never throws on any content; on errors the first 20 are
/// returned in reading order. Notes (commands that have no meaning here) and warnings come with the
/// value. O(bytes read + primitives).
Result<Scene> read_art(const std::string& path, const ReadArtOptions& options = {});

/// The same from memory; `name` stands in diagnostics and is the base of relative `read` paths.
Result<Scene> parse_art(std::string_view text, const std::string& name,
                        const ReadArtOptions& options = {});

}  // namespace cs2mesh
