#include "libfield/base/peak_memory.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

namespace cs2mesh {
namespace {

/// The mark before it was last set back.
std::atomic<std::uint64_t> highest_before = 0;

std::uint64_t mark() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

/// "5" sets the mark of the resident set back to its size now; see proc(5).
bool set_back() {
  const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = ::write(file, "5", 1) == 1;
  ::close(file);
  return done;
}

}  // namespace

std::uint64_t peak_memory_bytes() {
  return std::max(highest_before.load(), mark());
}

MemoryWatch::MemoryWatch() {
  ::malloc_trim(0);
  highest_before = peak_memory_bytes();
  own_ = set_back();
}

std::uint64_t MemoryWatch::peak_bytes() const {
  return mark();
}

}  // namespace cs2mesh
