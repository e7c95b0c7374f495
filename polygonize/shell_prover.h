// Proofs, triangle by triangle, that the surface is one sheet inside of a thin shell around a mesh.
#pragma once

#include <array>
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

struct Finding {
  Doubt doubt = Doubt::none;  ///< `distance`, `fold` or `crease`, in that order of precedence
  /// Where the distance is in doubt: the layers whose sign is, as far as was looked.
  bool outer = false, inner = false;
  /// Where a fold is in doubt: the surface crosses each segment once for all that, and no layer is
  /// turned inside out, so that the prism meets none of a neighbour's but at their border. What is
  /// left is that it might meet others.
  bool rises = false;
};

/// The corners of a triangle's prism, first the outer ones.
std::array<Vec3d, 6> prism_corners(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle);
/// Whether the hulls of the corners of two prisms are shown to have no point in common. False where
/// it could not be decided.
bool are_apart(const std::array<Vec3d, 6>& a, const std::array<Vec3d, 6>& b);

/// What to look for: where the surface is, first; that done, how it runs in there.
enum class Question : std::uint8_t { signs, slopes };

/// What is not proven of each of some triangles, which should be near each other. See certificate.h
/// for what is proven.
std::vector<Finding> look_into(const ImplicitSurface& surface, const TriangleMesh& mesh,
                               const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                               Question question, ProverCounts& counts);

}  // namespace cs2mesh
