// How a verb talks to its user: words to stderr, results to stdout or files.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "cli/run_limits.h"
#include "libfield/base/result.h"
#include "libfield/field/counted_surface.h"
#include "polygonize/stage_log.h"

namespace cs2mesh {

class Console {
 public:
  explicit Console(const CommonOptions& options);

  /// Prints errors and warnings, notes only with --verbose.
  void show(const std::vector<Diagnostic>& diagnostics);
  /// A line for people; silent with --quiet.
  void say(const std::string& line);
  /// The same with --verbose only.
  void remark(const std::string& line);
  /// The value, after its remarks are shown; or throws Exit after the errors are shown.
  template <class T>
  T take(Result<T> result) {
    if (!result) stop_if_interrupted();
    show(result.diagnostics());
    if (!result) throw Exit{exit_status(result.diagnostics())};
    return *std::move(result);
  }
  /// Shows the error and throws Exit with its status.
  [[noreturn]] void fail(Failure failure, const std::string& message, SourceLocation where = {});
  /// Throws Exit{kInterrupted} after Ctrl-C, Exit{kLimitReached} when the time is up or there is
  /// too much memory in use.
  void stop_if_interrupted();
  /// The end of a run that was refused memory: throws Exit{kLimitReached}.
  [[noreturn]] void fail_for_memory();

  Progress& progress() { return limits_; }
  /// What was reported to progress().
  const StageLog& stages() const { return stages_; }
  /// For surfaces to count in; the stages tell what was counted in each.
  EvaluationCounter& counter() { return counter_; }
  Evaluations evaluations() const { return counter_.total(); }
  bool json() const { return options_.json; }
  int threads() const;

 private:
  CommonOptions options_;
  ProgressBar progress_;
  EvaluationCounter counter_;
  StageLog stages_;
  RunLimits limits_;
  std::unique_ptr<tbb::global_control> thread_limit_;
};

}  // namespace cs2mesh
