// Whoever asks gets the same, and it is made no more often than there are threads.
#include "libfield/base/made_once.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <vector>

namespace cs2mesh {
namespace {

TEST(MadeOnce, IsMadeWhenItIsAskedFor) {
  int made = 0;
  const auto make = [&] { return ++made; };
  const MadeOnce<int> number;
  EXPECT_EQ(made, 0);
  EXPECT_EQ(number.get(make), 1);
  EXPECT_EQ(number.get(make), 1);
  EXPECT_EQ(made, 1);
}

TEST(MadeOnce, AllThreadsGetTheOneThatIsKept) {
  struct Counted {
    std::atomic<int>* alive;
    explicit Counted(std::atomic<int>* count) : alive(count) { ++*alive; }
    Counted(Counted&& other) noexcept : alive(other.alive) { ++*alive; }
    ~Counted() { --*alive; }
  };
  std::atomic<int> alive = 0;
  {
    const MadeOnce<Counted> one;
    std::vector<const Counted*> seen(1000);
    tbb::parallel_for(std::size_t{0}, seen.size(),
                      [&](std::size_t i) { seen[i] = &one.get([&] { return Counted(&alive); }); });
    for (const Counted* each : seen) EXPECT_EQ(each, seen.front());
    EXPECT_EQ(alive, 1);
  }
  EXPECT_EQ(alive, 0);
}

}  // namespace
}  // namespace cs2mesh
