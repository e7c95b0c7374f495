// The options that verbs share, and how a command line is taken apart.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/run_limits.h"
#include "libfield/base/aabb.h"
#include "libfield/scene/scene.h"

// Only what takes options apart pays for their library.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cs2mesh {

using Words = std::vector<std::string>;

/// What every verb understands; --json not those whose results are lines of text.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  std::optional<ProgressMode> progress;  ///< not set: a bar on a terminal
  int threads = 0;                       ///< 0: one a core
  RunLimits::Most most;
};
void add_common_options(CLI::App& app, CommonOptions& options);
void add_json_option(CLI::App& app, CommonOptions& options);
void add_limit_options(CLI::App& app, CommonOptions& options);

/// How a scene file is read.
struct SceneOptions {
  std::string path;
  std::map<std::string, std::string> defines;
  std::optional<Aabb> bounds;
};
void add_scene_options(CLI::App& app, SceneOptions& options);
/// As above plus --bounds, for verbs that need a bounded surface.
void add_bounded_scene_options(CLI::App& app, SceneOptions& options);

/// A length as it stands on a command line: scene units, or a share of the scene's diagonal.
struct Length {
  double value = 0.0;
  bool relative = false;  ///< `value` is a fraction of the diagonal
  double absolute(double diagonal) const { return relative ? value * diagonal : value; }
};
/// `0.01` or `0.1%`; greater than 0 and finite.
std::optional<Length> parse_length(const std::string& text);
CLI::Option* add_length_option(CLI::App& app, const std::string& name, std::optional<Length>& out,
                               const std::string& description);

/// `100000000`, `500M` or `1.5G`: bytes, or so many times 2^10 (K), 2^20 (M), 2^30 (G) or 2^40 (T)
/// of them; 1 or more and below 2^63.
std::optional<std::uint64_t> parse_bytes(const std::string& text);

/// Takes the words of a command line apart. Prints help to stdout and throws Exit{kDone} where it
/// is asked for; prints what is wrong with the usage and throws Exit{kBadInput}.
void parse(CLI::App& app, const Words& arguments);

}  // namespace cs2mesh
