// Another program's work, as a function from its input to its output.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/result.h"

namespace cs2mesh {

struct ChildLimits {
  double seconds = 60;
  std::size_t output_bytes = std::size_t{64} << 20;
};

/// Runs the program words[0], looked for in PATH, with the other words as its arguments (no shell
/// sees them) and `input` as its standard input; returns what it wrote to its standard output.
/// Errors: it is not there, says by its status that it failed (the message quotes the first line of
/// its standard error), was killed, or is stopped here for going beyond a limit (Failure::output),
/// or by the user (Failure::interrupted). `words` is not empty (ContractViolation).
Result<std::string> run_child(const std::vector<std::string>& words, std::string_view input,
                              const ChildLimits& limits = {});

}  // namespace cs2mesh
