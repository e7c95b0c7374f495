// Blended balls whose field has bounds in the exponent.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/field.h"

namespace cs2mesh::test {

/// Eight Gaussian balls of radii up to a half and all stiffnesses, around the origin.
inline Field random_blobs(Random& random) {
  std::vector<Term> terms;
  for (int i = 0; i < 8; ++i) {
    Term term;
    const double radius = random.uniform(0.2, 0.5), b = random.uniform(1, 20);
    term.kernel = Gaussian{std::sqrt(b) / radius, b};
    term.primitive = Point{random.uniform() * random.direction()};
    term.frame = frame_of(term.primitive);
    terms.push_back(term);
  }
  return Field(std::move(terms), 1e-9);
}

}  // namespace cs2mesh::test
