// Collects what is said about a scene while it is read.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/diagnostics.h"

namespace cs2mesh {

/// Keeps diagnostics in reading order and in bounded memory: 20 errors, and each note or warning
/// once, with the number of its repetitions.
class DiagnosticLog {
 public:
  static constexpr int kMaxErrors = 20;

  /// Errors beyond kMaxErrors are dropped.
  void error(SourceLocation where, std::string message, Failure failure = Failure::bad_input);
  /// Says `message` at its first use; later uses with the same `key` only count.
  void once(Severity severity, std::string_view key, SourceLocation where, std::string message);

  bool failed() const { return errors_ > 0; }
  bool full() const { return errors_ >= kMaxErrors; }
  /// Everything; with `errors_only`, what the user needs to mend the scene.
  std::vector<Diagnostic> take(bool errors_only);

 private:
  struct Repeated {
    std::size_t index;  // into diagnostics_
    long count;
  };
  std::vector<Diagnostic> diagnostics_;
  std::map<std::string, Repeated, std::less<>> repeated_;
  int errors_ = 0;
};

/// `text` in quotes, for a message; cut where it is longer than 40 bytes.
std::string in_quotes(std::string_view text);

/// ", did you mean 'x'?" for the nearest of `candidates`, "" where none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace cs2mesh
