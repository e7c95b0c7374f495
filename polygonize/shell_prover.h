// Proofs, triangle by triangle, that the surface is one sheet inside of a thin shell around a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/certificate.h"
#include "polygonize/offset_shell.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Evaluations.
struct ProverCounts {
  std::size_t values = 0, gradients = 0, bounds = 0;

  ProverCounts& operator+=(const ProverCounts& other) {
    values += other.values;
    gradients += other.gradients;
    bounds += other.bounds;
    return *this;
  }
};

struct Finding {
  Doubt doubt = Doubt::none;  ///< `distance`, `fold`, `crease` or `profile`
  /// Where the distance is in doubt: the layers whose sign is, as far as was looked, and at which
  /// corners of the triangle it is wrong.
  bool outer = false, inner = false;
  std::array<bool, 3> wrong_outer{}, wrong_inner{};
  /// With the signs it was found that F grows inwards along the segments all over the prism: there
  /// is nothing left to ask about crossings.
  bool grows = false;
};

enum class Question : std::uint8_t {
  signs,      ///< F < 0 on the outer triangle and F > 0 on the inner one
  crossings,  ///< F grows inwards along the segments of the prism wherever it vanishes
  layers,     ///< F grows all over the prism along its segments and the normals of its layers
};

/// What is not proven of each of some triangles, which should be near each other. See certificate.h
/// for what is proven.
std::vector<Finding> look_into(const ImplicitSurface& surface, const TriangleMesh& mesh,
                               const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                               Question question, ProverCounts& counts);

}  // namespace cs2mesh
