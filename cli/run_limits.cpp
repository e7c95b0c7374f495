#include "cli/run_limits.h"

#include <cmath>

#include "cli/printed.h"
#include "libfield/base/peak_memory.h"

namespace cs2mesh {
namespace {

/// Seconds between looks at the memory, of which each costs microseconds.
constexpr double kBetweenLooks = 0.005;

std::string bytes_text(std::uint64_t bytes) {
  return printed("%.4g MiB", static_cast<double>(bytes) / 0x1p20);
}

}  // namespace

RunLimits::RunLimits(const Most& most, StageLog& stages)
    : most_(most), stages_(stages), deadline_(most.seconds, &stages) {}

void RunLimits::report(std::string_view stage, double fraction) {
  deadline_.report(stage, fraction);
}

bool RunLimits::cancelled() const {
  return deadline_.cancelled() || holds_too_much();
}

bool RunLimits::holds_too_much() const {
  if (most_.bytes == 0) return false;
  if (too_much_.load(std::memory_order_relaxed)) return true;
  const double now = deadline_.elapsed();
  double due = next_look_.load(std::memory_order_relaxed);
  // Of threads that come at once, one looks.
  if (now < due || !next_look_.compare_exchange_strong(due, now + kBetweenLooks)) return false;
  if (resident_memory_bytes() <= most_.bytes) return false;
  too_much_ = true;
  return true;
}

std::string RunLimits::in_stage() const {
  const std::string stage = stages_.stage();
  return stage.empty() ? "" : " in stage '" + stage + "'";
}

std::string RunLimits::reached() const {
  if (holds_too_much()) {
    return "more memory than " + bytes_text(most_.bytes) + " would be needed" + in_stage();
  }
  if (deadline_.passed()) {
    return "the time limit of " + printed("%.6g s", most_.seconds) + " was reached" + in_stage();
  }
  return "";
}

std::string RunLimits::out_of_memory() const {
  if (most_.bytes == 0) return "out of memory" + in_stage();
  return "more memory than " + bytes_text(most_.bytes) + " would be needed" + in_stage();
}

}  // namespace cs2mesh
