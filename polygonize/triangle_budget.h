// The smallest tolerance at which a mesh has no more than a number of triangles.
//
// Over a smooth surface the number grows like 1 / tolerance (the distance of a triangle is of the
// second order in its size), so a secant in logarithms finds it in a few meshings.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace cs2mesh {

struct TriangleBudget {
  std::size_t most_triangles = 0;
  double finest = 0.0;    ///< the tolerance that would be best; > 0
  double coarsest = 0.0;  ///< the largest that is tried, >= finest
  double first = 0.0;     ///< tried first, if it is between the two
  /// A mesh with this share of the triangles is good enough.
  double enough = 0.9;
  int most_tries = 10;  ///< meshings at most, but for those that no mesh fits
};

/// Makes a mesh to a tolerance and returns the number of its triangles.
using TrianglesAt = std::function<std::size_t(double tolerance)>;

/// The smallest of the tolerances tried at which the mesh had no more triangles than there may be;
/// none if there were more even at the coarsest. `finest` itself, if the mesh fits there, as far as
/// the others let that be expected; else one at which the number is `enough`, or between which and
/// one that does not fit there are 2 % at most; or the best after `most_tries`. Not promised where
/// the number is not monotone: that it is the smallest of all. Deterministic. Requires
/// 0 < finest <= coarsest (else ContractViolation).
std::optional<double> finest_within(const TriangleBudget& budget, const TrianglesAt& triangles_at);

}  // namespace cs2mesh
