#include "cli/run_limits.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <thread>

#include "cli/options.h"
#include "libfield/base/peak_memory.h"

namespace cs2mesh {
namespace {

TEST(RunLimits, WithoutLimitsNothingIsReached) {
  StageLog stages;
  RunLimits limits({}, stages);
  limits.report("octree", 0.5);
  EXPECT_EQ(stages.stage(), "octree");
  EXPECT_FALSE(limits.cancelled());
  EXPECT_EQ(limits.reached(), "");
}

TEST(RunLimits, TimeRunsOutInAStage) {
  StageLog stages;
  RunLimits::Most most;
  most.seconds = 0.02;
  RunLimits limits(most, stages);
  limits.report("remesh", 0.0);
  while (!limits.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(limits.reached(), "the time limit of 0.02 s was reached in stage 'remesh'");
}

TEST(RunLimits, TooMuchMemoryStaysTooMuch) {
  StageLog stages;
  RunLimits::Most most;
  most.bytes = 1 << 20;  // no process fits
  RunLimits limits(most, stages);
  limits.report("refine", 0.0);
  EXPECT_TRUE(limits.cancelled());
  EXPECT_TRUE(limits.cancelled());
  EXPECT_EQ(limits.reached(), "more memory than 1 MiB would be needed in stage 'refine'");
  EXPECT_EQ(limits.out_of_memory(), limits.reached());
}

TEST(RunLimits, EnoughMemoryIsNoReasonToStop) {
  StageLog stages;
  RunLimits::Most most;
  most.bytes = std::uint64_t{1} << 50;
  const RunLimits limits(most, stages);
  EXPECT_FALSE(limits.cancelled());
  EXPECT_EQ(limits.reached(), "");
  EXPECT_GT(resident_memory_bytes(), 1U << 20);
  EXPECT_LE(resident_memory_bytes(), peak_memory_bytes() + (1U << 20));
}

TEST(Options, BytesOnACommandLine) {
  EXPECT_EQ(parse_bytes("1"), 1U);
  EXPECT_EQ(parse_bytes("1000000"), 1000000U);
  EXPECT_EQ(parse_bytes("64K"), 64U << 10);
  EXPECT_EQ(parse_bytes("1.5g"), 3U << 29);
  EXPECT_EQ(parse_bytes("2T"), std::uint64_t{2} << 40);
  for (const char* text : {"", "M", "0", "-1", "1e30", "nan", "inf", "1MB", "1 M", "9999999999G"}) {
    EXPECT_FALSE(parse_bytes(text)) << text;
  }
}

}  // namespace
}  // namespace cs2mesh
