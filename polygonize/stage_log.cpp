#include "polygonize/stage_log.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace cs2mesh {

double cpu_seconds() {
  timespec time{};
  if (::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

StageLog::StageLog(const EvaluationCounter* counter, Progress* whole)
    : counter_(counter), whole_(whole) {}

void StageLog::report(std::string_view stage, double fraction) {
  {
    const std::lock_guard lock(mutex_);
    if (stage != stage_) {
      const Moment moment = now();
      settle(costs_, moment);
      stage_ = stage;
      begin_ = moment;
    }
  }
  if (whole_ != nullptr) whole_->report(stage, fraction);
}

std::string StageLog::stage() const {
  const std::lock_guard lock(mutex_);
  return stage_;
}

std::vector<StageCost> StageLog::costs() const {
  const std::lock_guard lock(mutex_);
  std::vector<StageCost> costs = costs_;
  settle(costs, now());
  return costs;
}

StageLog::Moment StageLog::now() const {
  using Clock = std::chrono::steady_clock;
  Moment moment;
  moment.seconds = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  moment.cpu_seconds = cs2mesh::cpu_seconds();
  if (counter_ != nullptr) moment.evaluations = counter_->total();
  return moment;
}

void StageLog::settle(std::vector<StageCost>& costs, const Moment& moment) const {
  if (stage_.empty()) return;
  auto cost = std::find_if(costs.begin(), costs.end(),
                           [this](const StageCost& entry) { return entry.stage == stage_; });
  if (cost == costs.end()) cost = costs.insert(costs.end(), {stage_, 0.0, 0.0, {}});
  cost->seconds += moment.seconds - begin_.seconds;
  cost->cpu_seconds += moment.cpu_seconds - begin_.cpu_seconds;
  cost->evaluations += moment.evaluations - begin_.evaluations;
}

}  // namespace cs2mesh
