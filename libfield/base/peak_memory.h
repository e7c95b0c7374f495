// How much memory the process has held, at most.
#pragma once

#include <cstdint>

namespace cs2mesh {

/// The most memory that the process has had resident at once, bytes; watches change nothing of it.
/// 0 where the system does not say. Of a process with several watches alive at once, a lower bound.
std::uint64_t peak_memory_bytes();

/// The memory that the process has resident now, bytes; 0 where the system does not say (Linux:
/// /proc/self/statm). About a microsecond.
std::uint64_t resident_memory_bytes();

/// Makes the system refuse the process more than `bytes` of private memory, for good: what asks for
/// more gets std::bad_alloc. Stacks of `threads` threads come on top. False where the system
/// cannot, or where the process has more already, as under AddressSanitizer.
bool refuse_memory_beyond(std::uint64_t bytes, int threads);

/// The most memory resident at once from the construction of the watch on. The kernel's mark is
/// set back through /proc/self/clear_refs (Linux), after freed memory has been handed back to the
/// system. Where that is not allowed the mark is that of the process since its start: own() tells.
/// The mark is the process's one and only: of watches alive at once, only the last made is right.
class MemoryWatch {
 public:
  MemoryWatch();

  std::uint64_t peak_bytes() const;
  /// Whether peak_bytes() is of this watch's time alone.
  bool own() const { return own_; }

 private:
  bool own_ = false;
};

}  // namespace cs2mesh
