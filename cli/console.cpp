#include "cli/console.h"

#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "cli/interrupt.h"
#include "libfield/base/peak_memory.h"

namespace cs2mesh {
namespace {

ProgressMode progress_mode(const CommonOptions& options) {
  if (options.progress) return *options.progress;
  const bool terminal = isatty(STDERR_FILENO) == 1;
  return terminal && !options.quiet ? ProgressMode::bar : ProgressMode::none;
}

bool in_colour() {
  const char* no_color = std::getenv("NO_COLOR");
  return isatty(STDERR_FILENO) == 1 && (no_color == nullptr || *no_color == '\0');
}

/// The word that says how bad it is, in bold on a terminal.
std::string decorated(const Diagnostic& diagnostic) {
  std::string text = to_string(diagnostic);
  if (!in_colour()) return text;
  const std::string word = diagnostic.severity == Severity::error     ? "error:"
                           : diagnostic.severity == Severity::warning ? "warning:"
                                                                      : "note:";
  const std::size_t at = text.find(word);
  if (at == std::string::npos) return text;
  const std::string colour = diagnostic.severity == Severity::error ? "\033[1;31m" : "\033[1m";
  return text.replace(at, word.size(), colour + word + "\033[0m");
}

}  // namespace

Console::Console(const CommonOptions& options)
    : options_(options),
      progress_(progress_mode(options)),
      stages_(&counter_, &progress_),
      limits_(options.most, stages_) {
  if (options_.threads > 0) {
    thread_limit_ = std::make_unique<tbb::global_control>(
        tbb::global_control::max_allowed_parallelism, options_.threads);
  }
  // For what is asked for between two looks at what is in use.
  if (options_.most.bytes > 0) refuse_memory_beyond(options_.most.bytes, threads());
}

int Console::threads() const {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void Console::show(const std::vector<Diagnostic>& diagnostics) {
  if (diagnostics.empty()) return;
  progress_.clear();
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.severity == Severity::note && !options_.verbose) continue;
    std::cerr << decorated(diagnostic) << '\n';
  }
}

void Console::say(const std::string& line) {
  if (options_.quiet) return;
  progress_.clear();
  std::cerr << line << '\n';
}

void Console::remark(const std::string& line) {
  if (options_.verbose) say(line);
}

void Console::fail(Failure failure, const std::string& message, SourceLocation where) {
  show({error_at(std::move(where), message, failure)});
  throw Exit{exit_status(failure)};
}

void Console::fail_for_memory() {
  fail(Failure::limit, limits_.out_of_memory() + "; nothing was written");
}

void Console::stop_if_interrupted() {
  if (interrupted()) fail(Failure::interrupted, "interrupted; nothing was written");
  const std::string reached = limits_.reached();
  if (!reached.empty()) fail(Failure::limit, reached + "; nothing was written");
}

}  // namespace cs2mesh
