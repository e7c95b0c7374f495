#include "cli/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "cli/exit_status.h"

namespace cs2mesh {
namespace {

// A signal handler may touch lock-free atomics and nothing that allocates or locks.
std::atomic<int> requests = 0;
std::atomic<int> writers = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int /*signal*/) {
  if (requests.fetch_add(1) > 0 && writers == 0) _exit(kInterrupted);
}

}  // namespace

void install_interrupt_handler() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return requests > 0;
}

WhileWriting::WhileWriting() {
  ++writers;
}

WhileWriting::~WhileWriting() {
  --writers;
}

}  // namespace cs2mesh
