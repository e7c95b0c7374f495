// What is said to the user about an input: where, how bad, what.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cs2mesh {

/// A place in a text file; line and column count from 1, 0 where a whole file is meant.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
  friend bool operator==(const SourceLocation&, const SourceLocation&) = default;
};

/// Classes of failure; the command line maps each to its exit status.
enum class Failure {
  none,          ///< a note or a warning
  bad_input,     ///< the input is malformed or the usage is wrong
  unmeshable,    ///< well-formed, but asks for what cannot be meshed
  check_failed,  ///< a mesh breaks a promise
  tolerance,     ///< the tolerance was not reached
  limit,         ///< a limit of memory, time or count
  output,        ///< an output could not be written
  interrupted,   ///< the user asked to stop
};

enum class Severity { note, warning, error };

struct Diagnostic {
  Severity severity = Severity::error;
  Failure failure = Failure::bad_input;
  SourceLocation where;
  std::string message;
  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

/// `file:line:column: error: message`, leaving out what is unknown of the place.
std::string to_string(const Diagnostic& diagnostic);

/// The word of `candidates` nearest to `word` by edit distance, or "" if none is near enough to be
/// worth a "did you mean".
std::string_view nearest_word(std::string_view word,
                              const std::vector<std::string_view>& candidates);

}  // namespace cs2mesh
