// The exit statuses of the program, a promise to scripts.
#pragma once

#include <vector>

#include "libfield/base/diagnostics.h"

namespace cs2mesh {

enum ExitStatus : int {
  kDone = 0,
  kInternalError = 1,
  kBadInput = 2,
  kUnmeshable = 3,
  kCheckFailed = 4,
  kToleranceMissed = 5,
  kLimitReached = 6,
  kOutputFailed = 7,
  kInterrupted = 130,
};

inline ExitStatus exit_status(Failure failure) {
  switch (failure) {
    case Failure::none:
      return kDone;
    case Failure::bad_input:
      return kBadInput;
    case Failure::unmeshable:
      return kUnmeshable;
    case Failure::check_failed:
      return kCheckFailed;
    case Failure::tolerance:
      return kToleranceMissed;
    case Failure::limit:
      return kLimitReached;
    case Failure::output:
      return kOutputFailed;
    case Failure::interrupted:
      return kInterrupted;
  }
  return kInternalError;
}

/// The status of the first error; kDone without one.
inline ExitStatus exit_status(const std::vector<Diagnostic>& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.severity == Severity::error) return exit_status(diagnostic.failure);
  }
  return kDone;
}

/// Thrown inside cli/ to end the program with that status, everything having been said already.
struct Exit {
  ExitStatus status = kDone;
};

}  // namespace cs2mesh
