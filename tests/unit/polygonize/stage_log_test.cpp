#include "polygonize/stage_log.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace cs2mesh {
namespace {

TEST(StageLog, PutsEachEvaluationDownToItsStage) {
  EvaluationCounter counter;
  StageLog log(&counter);
  counter.add({7, 0, 0, 0});  // of no stage
  EXPECT_EQ(log.stage(), "");
  EXPECT_TRUE(log.costs().empty());
  log.report("octree", 0.0);
  counter.add({1, 2, 3, 4});
  log.report("octree", 0.5);
  counter.add({10, 20, 30, 40});
  log.report("refine", 0.0);
  counter.add({100, 0, 0, 0});
  log.report("octree", 0.0);
  counter.add({0, 0, 0, 1000});
  EXPECT_EQ(log.stage(), "octree");

  const std::vector<StageCost> costs = log.costs();
  ASSERT_EQ(costs.size(), 2U);
  EXPECT_EQ(costs[0].stage, "octree");
  EXPECT_EQ(costs[0].evaluations, (Evaluations{11, 22, 33, 1044}));
  EXPECT_EQ(costs[1].stage, "refine");
  EXPECT_EQ(costs[1].evaluations, (Evaluations{100, 0, 0, 0}));
  for (const StageCost& cost : costs) {
    EXPECT_GE(cost.seconds, 0);
    EXPECT_GE(cost.cpu_seconds, 0);
  }
}

TEST(StageLog, AskingDoesNotChangeIt) {
  EvaluationCounter counter;
  StageLog log(&counter);
  log.report("one", 0.0);
  counter.add({1, 0, 0, 0});
  EXPECT_EQ(log.costs().front().evaluations.values, 1U);
  EXPECT_EQ(log.costs().front().evaluations.values, 1U);
  const double before = log.costs().front().seconds;
  EXPECT_LE(before, log.costs().front().seconds);
}

/// Remembers what it was told.
class Listener final : public Progress {
 public:
  void report(std::string_view stage, double fraction) override {
    last = {std::string(stage), fraction};
  }
  bool cancelled() const override { return stop; }
  std::pair<std::string, double> last;
  bool stop = false;
};

TEST(StageLog, PassesReportsAndTheWishToStopOn) {
  Listener listener;
  StageLog log(nullptr, &listener);
  log.report("export", 0.25);
  EXPECT_EQ(listener.last, (std::pair<std::string, double>{"export", 0.25}));
  EXPECT_FALSE(log.cancelled());
  listener.stop = true;
  EXPECT_TRUE(log.cancelled());
  EXPECT_EQ(log.costs().front().evaluations, Evaluations{});
}

}  // namespace
}  // namespace cs2mesh
