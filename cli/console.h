// How a verb talks to its user: words to stderr, results to stdout or files.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "libfield/base/result.h"

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
    show(result.diagnostics());
    if (!result) throw Exit{exit_status(result.diagnostics())};
    return *std::move(result);
  }
  /// Shows the error and throws Exit with its status.
  [[noreturn]] void fail(Failure failure, const std::string& message, SourceLocation where = {});
  /// Throws Exit{kInterrupted} after Ctrl-C.
  void stop_if_interrupted();

  Progress& progress() { return progress_; }
  bool json() const { return options_.json; }
  int threads() const;

 private:
  CommonOptions options_;
  ProgressBar progress_;
  std::unique_ptr<tbb::global_control> thread_limit_;
};

}  // namespace cs2mesh
