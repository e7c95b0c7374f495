#include "libfield/base/peak_memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstring>

namespace cs2mesh {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20;

/// Has so much memory resident for a while. Of the system itself, since sanitizers keep what is
/// freed.
void hold(std::size_t bytes) {
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::memset(memory, 1, bytes);
  ::munmap(memory, bytes);
}

TEST(PeakMemory, AWatchTellsOfItsOwnTime) {
  hold(200 * kMegabyte);
  const std::uint64_t before = peak_memory_bytes();
  EXPECT_GE(before, 200 * kMegabyte);
  const MemoryWatch watch;
  const std::uint64_t start = watch.peak_bytes();
  hold(60 * kMegabyte);
  EXPECT_GE(watch.peak_bytes(), 60 * kMegabyte);
  if (watch.own()) {
    EXPECT_LT(start, before);
    EXPECT_LT(watch.peak_bytes(), start + 100 * kMegabyte);
  }
  // The process's own peak does not forget.
  EXPECT_GE(peak_memory_bytes(), before);
}

}  // namespace
}  // namespace cs2mesh
