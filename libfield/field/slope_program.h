// The least slope along a direction that a sum of terms can have in a box where it has a given
// value.
#pragma once

#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {

class SlopeProgram {
 public:
  /// Adds what is known of the term and of its derivative along the direction over the box: tight
  /// where all of the primitive lies ahead, however steep the term; else like the gradient's bound
  /// of first order. Some 50 ns to 1 us.
  void add(const Term& term, const BatchBox& box, const Vec3d& direction);
  /// Adds a function by its range and a lower bound of its slope.
  void add(const Interval& value, double slope) {
    fixed_ = fixed_ + value;
    slope_ += slope;
  }
  /// Adds a function by its range, which has no negative values, and a lower bound of its slope
  /// over its value.
  void add_rate(const Interval& value, double rate) { fillable_.push_back({value, rate}); }
  /// A lower bound of the slope where the sum is `total`; infinite if it is so nowhere.
  double least(double total);

 private:
  /// A function with a slope of at least `rate` times its value.
  struct Fillable {
    Interval value;
    double rate = 0.0;
  };
  std::vector<Fillable> fillable_;
  Interval fixed_{0.0};
  double slope_ = 0.0;
};

}  // namespace cs2mesh
