#include "cli/progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/interrupt.h"

namespace cs2mesh {
namespace {

constexpr auto kQuietTime = std::chrono::seconds(1);
constexpr auto kBetweenPrints = std::chrono::milliseconds(100);

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

ProgressBar::ProgressBar(ProgressMode mode) : mode_(mode) {}

ProgressBar::~ProgressBar() {
  clear();
}

bool ProgressBar::cancelled() const {
  return interrupted();
}

void ProgressBar::report(std::string_view stage, double fraction) {
  if (mode_ == ProgressMode::none) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  const Clock::time_point now = Clock::now();
  const bool new_stage = stage != stage_;
  if (new_stage) {
    stage_ = stage;
    stage_start_ = now;
  }
  if (!new_stage && now - last_print_ < kBetweenPrints) return;
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (mode_ == ProgressMode::json) {
    print_json(fraction, now);
  } else if (now - start_ >= kQuietTime) {
    print_bar(fraction, now);
  }
  last_print_ = now;
}

void ProgressBar::clear() {
  const std::lock_guard lock(mutex_);
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

void ProgressBar::print_bar(double fraction, Clock::time_point now) {
  constexpr int kWidth = 30;
  const int full = static_cast<int>(fraction * kWidth);
  const std::string bar = std::string(full, '#') + std::string(kWidth - full, '.');
  const double elapsed = seconds(now - stage_start_);
  std::fprintf(stderr, "\r\033[K%-10s [%s] %3d %%", stage_.c_str(), bar.c_str(),
               static_cast<int>(100 * fraction));
  // Under 2 % an extrapolation says nothing.
  if (fraction >= 0.02) {
    std::fprintf(stderr, "  %.0f s left", elapsed * (1.0 - fraction) / fraction);
  }
  std::fflush(stderr);
  shown_ = true;
}

void ProgressBar::print_json(double fraction, Clock::time_point now) {
  const nlohmann::ordered_json line = {
      {"stage", stage_}, {"fraction", fraction}, {"seconds", seconds(now - start_)}};
  std::fprintf(stderr, "%s\n", line.dump().c_str());
}

}  // namespace cs2mesh
