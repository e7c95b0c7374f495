// Proofs, triangle by triangle, that the surface is one sheet inside of a thin shell around a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/certificate.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The shell of a mesh: at each vertex it reaches `outer` along the direction and `inner` against
/// it.
struct OffsetShell {
  std::vector<Vec3d> direction;  ///< unit, outwards
  std::vector<double> outer, inner;
};

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

/// What is not proven of each of some triangles, which should be near each other: `distance`,
/// `fold` or `crease`, in that order of precedence. See certificate.h for what is proven.
std::vector<Doubt> doubts_of(const ImplicitSurface& surface, const TriangleMesh& mesh,
                             const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                             ProverCounts& counts);

}  // namespace cs2mesh
