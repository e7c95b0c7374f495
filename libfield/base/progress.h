// How long-running stages report and are stopped.
#pragma once

#include <string_view>

namespace cs2mesh {

/// Called now and then from any thread, never in an inner loop.
class Progress {
 public:
  virtual ~Progress() = default;
  /// `fraction` of `stage` is done, 0..1.
  virtual void report(std::string_view /*stage*/, double /*fraction*/) {}
  /// True once the user wants to stop; stages then return Failure::interrupted soon.
  virtual bool cancelled() const { return false; }
};

}  // namespace cs2mesh
