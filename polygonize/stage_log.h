// What each stage of a run takes: seconds and evaluations.
#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/counted_surface.h"

namespace cs2mesh {

/// Seconds that all threads of the process have computed together, so far.
double cpu_seconds();

/// What was spent while a stage was the last that had been reported; of one that came several
/// times, all together.
struct StageCost {
  std::string stage;
  double seconds = 0.0;      ///< by the clock
  double cpu_seconds = 0.0;  ///< of all threads
  Evaluations evaluations;
};

/// Listens to the reports of stages, which it passes on to `whole`. From the first report of a
/// stage on, what is spent is put down to it, until another one reports. Safe to use from any
/// thread.
class StageLog final : public Progress {
 public:
  /// `counter` and `whole` may be null and outlive this.
  explicit StageLog(const EvaluationCounter* counter = nullptr, Progress* whole = nullptr);

  void report(std::string_view stage, double fraction) override;
  bool cancelled() const override { return cs2mesh::cancelled(whole_); }

  /// The stage that reported last; empty before the first.
  std::string stage() const;
  /// Every stage in the order of their first reports, the present one up to now.
  std::vector<StageCost> costs() const;

 private:
  struct Moment {
    double seconds = 0.0, cpu_seconds = 0.0;
    Evaluations evaluations;
  };
  Moment now() const;
  /// Adds what was spent since the present stage began.
  void settle(std::vector<StageCost>& costs, const Moment& moment) const;

  const EvaluationCounter* counter_;
  Progress* whole_;
  mutable std::mutex mutex_;
  std::string stage_;
  Moment begin_;
  std::vector<StageCost> costs_;
};

}  // namespace cs2mesh
