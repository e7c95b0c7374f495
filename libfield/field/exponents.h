// Bounds of a sum of functions f = exp(phi) near a point, from phi and its gradient there: the
// formulas of log_sum.h, a function a lane.
//
// Legend: phi, g the exponent and its gradient at the centre p0, top the greatest phi; most, least
// D^2 phi is between -most and -least everywhere; h the half edges of the box, r half its diagonal;
// w = exp(phi - top), G = sum w g / sum w.
#pragma once

#include <cstddef>
#include <span>

#include "libfield/base/vec.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

/// A number a function in each row, `count` of them, a whole multiple of kMostExponents; rows
/// follow each other in the order of the enumeration. What fills up the last pack has phi so far
/// below `top` that it does not count, and otherwise the numbers of another.
struct ExponentRows {
  enum Row { phi, gx, gy, gz, most, least, weight, kRows };
  static constexpr std::size_t kMostLanes = 8;

  double* numbers = nullptr;
  std::size_t count = 0;
  std::size_t first = 0;  ///< the place of the greatest phi

  const double* operator[](Row row) const { return numbers + row * count; }
  double* operator[](Row row) { return numbers + row * count; }
};

/// Rounding of exponents, relative to the largest there are: those of points are known to some ulp
/// of log A and a^2 r^2, those of others to 64 ulp of f.
inline constexpr double kExponentRounding = 1e-12;

/// A box around the point.
struct ExponentBox {
  Vec3d half;
  double radius = 0.0;
};

/// Sums over the functions relative to the one with the greatest phi: of lower bounds of w (d . g)
/// over the box, of upper bounds of w, and of the size of what was added to the first.
struct SlopeSums {
  double slope = 0.0, weight = 0.0, size = 0.0;
};

/// sum w, sum w g, sum w most.
struct WeightSums {
  double weight = 0.0;
  Vec3d gradient;
  double most = 0.0;
};

/// Of upper bounds over the box: sum w (e^s - 1 - s) with s >= |(g - G) . d|, and sum exp(phi -
/// top).
struct RiseSums {
  double excess = 0.0, apart = 0.0;
};

/// The sums, with the widest instructions that the machine has.
struct ExponentTable {
  SlopeSums (*slopes)(const ExponentRows& rows, const ExponentBox& box, const Vec3d& direction);
  /// Fills the row of weights.
  WeightSums (*weights)(ExponentRows& rows);
  /// After weights(); `mean` is G.
  RiseSums (*rises)(const ExponentRows& rows, const ExponentBox& box, const Vec3d& mean);
};
const ExponentTable& exponent_table();

}  // namespace cs2mesh
