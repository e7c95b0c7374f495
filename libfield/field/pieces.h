// Primitives cut in two: what a field is the sum of at any fineness.
#pragma once

#include <utility>

#include "libfield/field/term.h"

namespace cs2mesh {

/// Whether the term may be cut: over a segment, an arc or a triangle, without profiles.
bool can_be_halved(const Term& term);

/// Two terms whose sum is the term, to the rounding of their common end: a segment or an arc at its
/// middle, a triangle across its longest edge. Such terms only.
std::pair<Term, Term> halves(const Term& term);

}  // namespace cs2mesh
