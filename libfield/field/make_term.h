// A soft element of the scene as a term of its field.
#pragma once

#include <optional>

#include "libfield/base/result.h"
#include "libfield/field/term.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// A term, with what sampling and framing want to know of it.
struct MadeTerm {
  std::optional<Term> term;  ///< none for strength 0, and for cones
  /// Its radius in isolation in scene units (the smallest, under a non-uniform scale); where no
  /// radius is in force, the length over which its kernel falls off.
  double radius = 0.0;
};

/// Width and amplitude follow from (R, B) by the rule of isolation, or from `width`. Errors, at the
/// element: neither radius nor width in force; no blobbiness; an inverse kernel on a plane
/// (unmeshable); a taper with a kernel other than Cauchy and Gaussian. A primitive of negligible
/// measure becomes a point, with a note.
/// A cone has no term, with a warning.
Result<MadeTerm> make_term(const Scene& scene, const Element& element);

/// Whether the measure of the primitive is negligible beside R (1e-12 R, 1e-12 R^2 for areas).
bool is_degenerate(const Primitive& primitive, double radius);

}  // namespace cs2mesh
