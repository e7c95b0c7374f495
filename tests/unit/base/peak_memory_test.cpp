#include "libfield/base/peak_memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <new>

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

TEST(PeakMemory, WhatIsResidentComesAndGoes) {
  const std::uint64_t before = resident_memory_bytes();
  ASSERT_GT(before, kMegabyte);
  const std::size_t bytes = 80 * kMegabyte;
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::memset(memory, 1, bytes);
  EXPECT_GE(resident_memory_bytes(), before + 60 * kMegabyte);
  ::munmap(memory, bytes);
  EXPECT_LT(resident_memory_bytes(), before + 60 * kMegabyte);
}

/// Ends the process: 0 where what is asked for beyond the limit is refused, or no limit can be set.
[[noreturn]] void ask_for_too_much() {
  if (!refuse_memory_beyond(512 * kMegabyte, 1)) std::_Exit(0);
  try {
    auto* const memory = static_cast<char*>(::operator new(2048 * kMegabyte));
    *memory = 1;
  } catch (const std::bad_alloc&) {
    std::_Exit(0);
  }
  std::_Exit(1);
}

TEST(PeakMemory, WhatIsBeyondALimitIsRefused) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(ask_for_too_much(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cs2mesh
