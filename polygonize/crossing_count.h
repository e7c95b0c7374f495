// How often the surface crosses a segment.
#pragma once

#include <cstddef>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// What was asked of a field.
struct FieldCounts {
  std::size_t values = 0, gradients = 0;  ///< evaluations; a jet is one of each
  std::size_t enclosures = 0, slopes = 0;

  FieldCounts& operator+=(const FieldCounts& other) {
    values += other.values;
    gradients += other.gradients;
    enclosures += other.enclosures;
    slopes += other.slopes;
    return *this;
  }
};

/// How often F changes its side on the segment from `a` to `b`, where that is proven and less than
/// twice; else 2, which says nothing. `at_a` is the jet of F at a. By Taylor's formula at one to
/// four points of the segment, by enclosures and least_slope() between them; what was asked of F is
/// added to `counts`.
int count_crossings(const ImplicitSurface& surface, const Vec3d& a, const Jet& at_a, const Vec3d& b,
                    FieldCounts& counts);

}  // namespace cs2mesh
