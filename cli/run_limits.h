// The time and the memory that a run may take.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <string>

#include "polygonize/deadline.h"
#include "polygonize/stage_log.h"

namespace cs2mesh {

/// Listens to the reports of stages, which it passes on to a log, and asks to stop once the run has
/// taken its time, holds more memory than it may, or the log asks to. How soon a stage then ends is
/// up to the stage.
class RunLimits final : public Progress {
 public:
  struct Most {
    double seconds = std::numeric_limits<double>::infinity();  ///< from the construction on
    std::uint64_t bytes = 0;                                   ///< resident at once; 0: no limit
  };

  /// `stages` outlives this.
  RunLimits(const Most& most, StageLog& stages);

  void report(std::string_view stage, double fraction) override;
  bool cancelled() const override;

  /// Which limit was reached in which stage, for people; "" if none was. Looks at the clock, too.
  std::string reached() const;
  /// What is to be said where memory was refused.
  std::string out_of_memory() const;

 private:
  bool holds_too_much() const;
  std::string in_stage() const;

  Most most_;
  StageLog& stages_;
  Deadline deadline_;
  mutable std::atomic<bool> too_much_{false};  ///< once: stages may give memory back as they stop
  mutable std::atomic<double> next_look_{0.0};
};

}  // namespace cs2mesh
