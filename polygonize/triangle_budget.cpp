#include "polygonize/triangle_budget.h"

#include <algorithm>
#include <cmath>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// A share of the triangles that is aimed at: some room for what the law does not tell.
constexpr double kAim = 0.95;
/// Between a tolerance that fits and one that does not, this ratio is no more worth a meshing.
constexpr double kClose = 1.02;
/// Of the way between them, in logarithms, the next is at least this far from either.
constexpr double kMargin = 0.1;

class Search {
 public:
  explicit Search(const TriangleBudget& budget)
      : budget_(budget), aim_(kAim * static_cast<double>(budget.most_triangles)) {}

  std::optional<double> run(const TrianglesAt& triangles_at) {
    double tolerance = std::clamp(budget_.first, budget_.finest, budget_.coarsest);
    for (int tries = 1;; ++tries) {
      const Try now{tolerance, triangles_at(tolerance)};
      const bool fits = now.triangles <= budget_.most_triangles;
      (fits ? fits_ : over_) = now;
      if (!fits && tolerance >= budget_.coarsest) return std::nullopt;
      if (fits_ && (done(now) || tries >= budget_.most_tries)) return fits_->tolerance;
      tolerance = next(now);
    }
  }

 private:
  struct Try {
    double tolerance = 0.0;
    std::size_t triangles = 0;
    double log_triangles() const { return std::log(std::max(1.0, static_cast<double>(triangles))); }
  };

  bool done(const Try& now) const {
    if (now.tolerance == fits_->tolerance) {
      const double share =
          static_cast<double>(now.triangles) / static_cast<double>(budget_.most_triangles);
      if (now.tolerance <= budget_.finest || share >= budget_.enough) return true;
    }
    return over_ && fits_->tolerance <= kClose * over_->tolerance;
  }

  double next(const Try& now) {
    if (fits_ && over_) return between();
    const double ratio = static_cast<double>(std::max<std::size_t>(now.triangles, 1)) / aim_;
    if (fits_) return std::max(budget_.finest, now.tolerance * ratio);
    // Where the shape alone takes many triangles, the law leads nowhere: larger and larger steps.
    step_ *= 2;
    return std::min(budget_.coarsest, now.tolerance * std::max(ratio, step_));
  }

  /// Where the line through the two, in logarithms, has as many triangles as are aimed at.
  double between() const {
    const double fine = std::log(over_->tolerance), coarse = std::log(fits_->tolerance);
    const double drop = over_->log_triangles() - fits_->log_triangles();
    const double share = (over_->log_triangles() - std::log(aim_)) / drop;
    return std::exp(std::lerp(fine, coarse, std::clamp(share, kMargin, 1 - kMargin)));
  }

  const TriangleBudget& budget_;
  double aim_;
  std::optional<Try> fits_, over_;  ///< the finest that fits, and the coarsest below that does not
  double step_ = 1.0;
};

}  // namespace

std::optional<double> finest_within(const TriangleBudget& budget, const TrianglesAt& triangles_at) {
  require(budget.finest > 0 && budget.finest <= budget.coarsest,
          "finest_within: tolerances out of order");
  require(budget.most_triangles > 0, "finest_within: no triangles at all");
  return Search(budget).run(triangles_at);
}

}  // namespace cs2mesh
