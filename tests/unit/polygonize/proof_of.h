// A topology proof of a surface, for tests.
#pragma once

#include <gtest/gtest.h>

#include "polygonize/topology_proof.h"

namespace cs2mesh {

inline TopologyProof proof_of(const ImplicitSurface& surface, double smallest) {
  TopologyProof::Options options;
  options.smallest = smallest;
  Result<TopologyProof> proof = TopologyProof::build(surface, options);
  EXPECT_TRUE(proof);
  return *std::move(proof);
}

}  // namespace cs2mesh
