// Work that may take no longer than so many seconds.
#pragma once

#include <chrono>

#include "libfield/base/progress.h"

namespace cs2mesh {

/// Passes reports on to `whole`, which may be null, and asks to stop when it does or the time is
/// up. How soon the work then ends is up to the work.
class Deadline final : public Progress {
 public:
  /// Infinitely many seconds are no deadline.
  Deadline(double seconds, Progress* whole) : seconds_(seconds), whole_(whole) {}

  void report(std::string_view stage, double fraction) override {
    if (whole_ != nullptr) whole_->report(stage, fraction);
  }
  bool cancelled() const override { return cs2mesh::cancelled(whole_) || passed(); }

  bool passed() const { return elapsed() > seconds_; }
  /// Seconds since the construction.
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
  double seconds_;
  Progress* whole_;
};

}  // namespace cs2mesh
