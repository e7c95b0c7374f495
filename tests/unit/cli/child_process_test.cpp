#include "cli/child_process.h"

#include <gtest/gtest.h>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

std::string error_of(const Result<std::string>& result) {
  EXPECT_FALSE(result);
  return result ? "" : result.diagnostics().front().message;
}

TEST(ChildProcess, InputToOutput) {
  // More than a pipe holds.
  const std::string input(1'000'000, 'x');
  const Result<std::string> output = run_child({"cat"}, input);
  ASSERT_TRUE(output);
  EXPECT_EQ(*output, input);
}

TEST(ChildProcess, ArgumentsAreNoShellWords) {
  const Result<std::string> output = run_child({"printf", "%s|", "$HOME; echo `id`", "a b"}, "");
  ASSERT_TRUE(output);
  EXPECT_EQ(*output, "$HOME; echo `id`|a b|");
}

TEST(ChildProcess, InputThatNobodyReads) {
  EXPECT_TRUE(run_child({"true"}, std::string(1'000'000, 'x')));
}

TEST(ChildProcess, FailuresAreSaid) {
  EXPECT_NE(error_of(run_child({"no-such-program-anywhere"}, "")).find("cannot be run"),
            std::string::npos);
  EXPECT_EQ(error_of(run_child({"false"}, "")), "false failed");
  EXPECT_EQ(error_of(run_child({"sh", "-c", "echo; echo why >&2; echo more >&2; exit 3"}, "")),
            "sh failed: why");
  EXPECT_EQ(error_of(run_child({"sh", "-c", "kill -9 $$"}, "")), "sh was killed");
  EXPECT_THROW((void)run_child({}, ""), ContractViolation);
}

TEST(ChildProcess, LimitsEndIt) {
  ChildLimits limits;
  limits.seconds = 0.05;
  EXPECT_EQ(error_of(run_child({"sleep", "1000"}, "", limits)), "sleep takes too long");
  limits.seconds = 60;
  limits.output_bytes = 1'000'000;
  EXPECT_EQ(error_of(run_child({"yes"}, "", limits)), "yes says too much");
}

}  // namespace
}  // namespace cs2mesh
