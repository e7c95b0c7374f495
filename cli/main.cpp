// cs2mesh: the first word picks the verb; without one a scene is meshed.
#include <exception>
#include <iostream>
#include <new>

#include "cli/exit_status.h"
#include "cli/interrupt.h"
#include "cli/verbs.h"

namespace cs2mesh {
namespace {

int dispatch(Words arguments) {
  if (arguments.empty()) {
    std::cerr << overview();
    return kBadInput;
  }
  const std::string first = arguments.front();
  if (first == "-h" || first == "--help") {
    std::cout << overview();
    return kDone;
  }
  if (first == "--version") {
    std::cout << "cs2mesh " CS2MESH_VERSION "\n";
    return kDone;
  }
  for (const Verb& verb : all_verbs()) {
    if (first != verb.name) continue;
    arguments.erase(arguments.begin());
    return verb.run(arguments);
  }
  return run_mesh(arguments);
}

/// The last resort: nothing that goes wrong ends in a crash or without a word.
int guarded(const Words& arguments) {
  try {
    return dispatch(arguments);
  } catch (const Exit& exit) {
    return exit.status;
  } catch (const std::bad_alloc&) {
    std::cerr << "cs2mesh: error: out of memory\n";
    return kLimitReached;
  } catch (const std::exception& error) {
    std::cerr << "cs2mesh: internal error: " << error.what() << '\n';
    return kInternalError;
  }
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  cs2mesh::install_interrupt_handler();
  return cs2mesh::guarded(cs2mesh::Words(argv + 1, argv + argc));
}
