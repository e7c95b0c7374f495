// The verbs: what the first word of a command line may be. To add one: its file, and its line in
// verbs.cpp.
#pragma once

#include <span>
#include <string_view>

#include "cli/options.h"

namespace cs2mesh {

struct Verb {
  std::string_view name;  ///< "" for meshing, which has no verb
  std::string_view usage;
  std::string_view summary;
  /// Does the work; `arguments` are the words after the verb. Returns the exit status or throws
  /// Exit.
  int (*run)(const Words& arguments);
};

std::span<const Verb> all_verbs();

int run_mesh(const Words& arguments);
int run_render(const Words& arguments);
int run_compare(const Words& arguments);
int run_report(const Words& arguments);
int run_check(const Words& arguments);
int run_probe(const Words& arguments);
int run_info(const Words& arguments);
int run_help(const Words& arguments);

/// The text of `cs2mesh --help`.
std::string overview();

}  // namespace cs2mesh
