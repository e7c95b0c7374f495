// A soft element of the scene as terms of its field.
#pragma once

#include <vector>

#include "libfield/base/result.h"
#include "libfield/field/term.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// The terms of an element, with what sampling and framing want to know of it.
struct MadeTerms {
  std::vector<Term> terms;  ///< a polygon's pieces, else one; none for strength 0
  /// Its radius in isolation in scene units (the smallest, under a non-uniform scale; of a cone the
  /// larger one); where no radius is in force, the length over which its kernel falls off.
  double radius = 0.0;
};

/// Width and amplitude follow from (R, B) by the rule of isolation, or from `width`. Errors, at the
/// element: neither radius nor width in force; no blobbiness; an inverse kernel on a plane, or the
/// kernel 1/r on a cone (unmeshable); a taper with a kernel other than Cauchy and Gaussian; a cone
/// outside of its kernel's support, or too stiff. A primitive of negligible measure becomes a
/// point, with a note.
Result<MadeTerms> make_terms(const Scene& scene, const Element& element);

/// Whether the measure of the primitive is negligible beside R (1e-12 R, 1e-12 R^2 for areas).
bool is_degenerate(const Primitive& primitive, double radius);

}  // namespace cs2mesh
