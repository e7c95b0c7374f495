#include "libfield/base/peak_memory.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>

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

/// Pages in memory, and pages of data and stacks.
struct PageCounts {
  unsigned long resident = 0, data = 0;
};

PageCounts count_pages() {
  std::array<char, 256> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  const ssize_t size = ::read(file, text.data(), text.size() - 1);
  ::close(file);
  PageCounts pages;
  // Size, resident, shared, text, lib, data; see proc(5).
  if (size <= 0 ||
      std::sscanf(text.data(), "%*u %lu %*u %*u %*u %lu", &pages.resident, &pages.data) != 2) {
    return {};
  }
  return pages;
}

std::uint64_t page_size() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Of a thread that is made without a word about it.
std::uint64_t stack_bytes() {
  constexpr std::uint64_t kUnlimited = std::uint64_t{2} << 20;
  rlimit stack{};
  const bool known = ::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur != RLIM_INFINITY;
  return known ? stack.rlim_cur : kUnlimited;
}

}  // namespace

std::uint64_t resident_memory_bytes() {
  return count_pages().resident * page_size();
}

bool refuse_memory_beyond(std::uint64_t bytes, int threads) {
  const std::uint64_t most = bytes + static_cast<std::uint64_t>(threads) * stack_bytes();
  const std::uint64_t now = count_pages().data * page_size();
  rlimit limit{};
  if (now == 0 || now > most || ::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  if (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur <= most) return true;
  limit.rlim_cur = most;
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

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
