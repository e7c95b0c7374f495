// Progress on stderr: a bar on a terminal, a JSON object a line for programs, or nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "libfield/base/progress.h"

namespace cs2mesh {

enum class ProgressMode { none, bar, json };

/// Work of under a second shows no bar. Safe to report to from any thread; a report while another
/// is being printed is dropped.
class ProgressBar : public Progress {
 public:
  explicit ProgressBar(ProgressMode mode);
  ~ProgressBar() override;
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void report(std::string_view stage, double fraction) override;
  /// True after Ctrl-C.
  bool cancelled() const override;
  /// Removes the bar from the terminal, so that other words can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void print_bar(double fraction, Clock::time_point now);
  void print_json(double fraction, Clock::time_point now);

  ProgressMode mode_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point stage_start_ = start_;
  Clock::time_point last_print_ = start_;
  bool shown_ = false;
};

}  // namespace cs2mesh
