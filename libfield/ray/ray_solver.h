// Where a ray crosses a surface {F = 0}, with a bound for the error and no root missed.
#pragma once

#include <cstdint>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "libfield/ray/bound_tree.h"
#include "libfield/ray/ray.h"

namespace cs2mesh {

enum class RayStatus {
  hit,       ///< F changes its sign within t_error of t
  miss,      ///< F has no root on the range
  uncertain  ///< the bounds cannot tell whether F reaches 0 within t_error of t
};

/// A crossing of the surface, or the verdict on a whole range.
struct RayHit {
  double t = 0.0;        ///< along the ray; the end of the range for a miss
  double t_error = 0.0;  ///< the root differs from t by no more than this
  RayStatus status = RayStatus::miss;
  bool entering = false;  ///< F goes from negative (outside) to non-negative (inside); hits only
};

struct RaySolverOptions {
  /// The largest t_error that is aimed at, in scene units; 0: 1e-10 of the diagonal of bounds().
  /// Rounding of the position and of F can force a larger one, which is then reported.
  double accuracy = 0.0;
  /// What F may be off by, beyond rounding, from a function with the bounds that the surface
  /// claims, in units of F (the error budget of a Field). A value this near to 0 has no sign.
  double value_error = 0.0;
  /// Jets and bounds taken on one ray before what is left of it is declared uncertain.
  int max_evaluations = 20000;
};

/// What the solver asked of the surface; calls add to it.
struct RayCost {
  std::uint64_t jets = 0;    ///< evaluations of value and gradient
  std::uint64_t bounds = 0;  ///< enclosures and derivative bounds

  RayCost& operator+=(const RayCost& other) {
    jets += other.jets;
    bounds += other.bounds;
    return *this;
  }
};

/// The first sign change of F on ray.at([t0, t1]), 0 counting as positive: the way in for a ray
/// that starts outside, the way out for one that starts inside. An uncertain place before the first
/// certain hit is returned instead of it; to look further, ask again from t + t_error on.
///
/// What is certain rests on the surface's enclose, enclose_gradient and derivative_bound, which are
/// trusted, and on an allowance of 64 units of rounding of |F| at a place plus |lower bound of F|
/// over the ray, a measure of the terms that cancel where F is 0. A root within rounding of t0 or
/// t1 may be counted or not. t1 may be infinite, and t0 = -infinity; where neither the range nor
/// bounds() ends the ray, the verdict is uncertain with infinite t_error. Throws ContractViolation
/// if the direction is not a unit vector or a number is NaN.
RayHit first_hit(const ImplicitSurface& surface, const Ray& ray, double t0, double t1,
                 const RaySolverOptions& options = {}, RayCost* cost = nullptr);

/// Replaces `hits` by all sign changes and uncertain places on the range, in order of t. Two roots
/// nearer to each other than the accuracy appear as one uncertain place.
void all_hits(const ImplicitSurface& surface, const Ray& ray, double t0, double t1,
              const RaySolverOptions& options, std::vector<RayHit>& hits, RayCost* cost = nullptr);

/// The same by a tree of bounds, which takes most of the work off each ray: for many rays.
RayHit first_hit(const BoundTree& tree, const Ray& ray, double t0, double t1,
                 const RaySolverOptions& options = {}, RayCost* cost = nullptr);
void all_hits(const BoundTree& tree, const Ray& ray, double t0, double t1,
              const RaySolverOptions& options, std::vector<RayHit>& hits, RayCost* cost = nullptr);

}  // namespace cs2mesh
