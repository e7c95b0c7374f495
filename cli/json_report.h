// The JSON that --json prints and --report writes. Names are those of the manual, the same in every
// verb; lengths in scene units, times in seconds.
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/console.h"
#include "libfield/field/counted_surface.h"

namespace cs2mesh {

using Json = nlohmann::ordered_json;

/// Wall-clock time by stage.
class Stopwatch {
 public:
  /// Stages are reported to `progress`, if there is one, as they start.
  explicit Stopwatch(Progress* progress = nullptr) : progress_(progress) {}

  /// Ends the stage before and starts this one; a stage named again goes on adding up.
  void start(const std::string& stage);
  void stop();
  /// Adds a time that was measured elsewhere.
  void add(const std::string& stage, double seconds);
  /// {stage: seconds, ..., "total": seconds since this object was made}.
  Json seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  Progress* progress_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point stage_begin_ = begin_;
  std::string stage_;
  std::vector<std::pair<std::string, double>> spent_;
};

/// {"value": ..., "gradient": ..., "hessian": ..., "enclosure": ...}
Json to_json(const Evaluations& count);

/// Adds what every report ends with: seconds, peak_memory_bytes, threads, version.
void add_run(Json& report, const Stopwatch& watch, const Console& console);

/// Prints to stdout with --json, and writes to `path` unless it is empty. Throws Exit where the
/// file cannot be written.
void deliver(const Json& report, const std::string& path, Console& console);

}  // namespace cs2mesh
