// Runs a test with each instruction set that the machine has.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "libfield/field/term.h"
#include "libfield/simd/isa.h"

namespace cs2mesh::testing {

/// Calls test(isa) with that one in use, then goes back to what was in use before.
template <class Test>
void with_every_isa(const Test& test) {
  const Isa before = active_isa();
  for (const Isa isa : available_isas()) {
    SCOPED_TRACE(std::string("instructions: ") + std::string(name_of(isa)));
    use_isa(isa);
    test(isa);
  }
  use_isa(before);
}

inline Term plain_term(const Kernel& kernel, const Primitive& primitive) {
  return {kernel, primitive, frame_of(primitive), {}, 1.0, {}, {}, 0};
}

/// The field at one point as a scene's field evaluates it.
inline Jet accumulated(const Term& term, const Vec3d& point) {
  Jet jet;
  accumulate(term, {&point, 1}, {&jet, 1});
  return jet;
}

}  // namespace cs2mesh::testing
