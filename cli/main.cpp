// cs2mesh: the first word picks the verb; without one a scene is meshed.
#include <exception>
#include <iostream>
#include <limits>
#include <new>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

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

/// What one stage frees is for the next, rather than asked of the system again page by page: a
/// twentieth of the time of large meshes.
void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kLargest = 32 << 20;  // the most that glibc takes; larger blocks come and go
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
#endif
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  cs2mesh::keep_freed_memory();
  cs2mesh::install_interrupt_handler();
  return cs2mesh::guarded(cs2mesh::Words(argv + 1, argv + argc));
}
