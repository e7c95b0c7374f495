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

/// Whether there is a user who wants to stop.
inline bool cancelled(const Progress* progress) {
  return progress != nullptr && progress->cancelled();
}

}  // namespace cs2mesh
