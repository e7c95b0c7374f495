// Points all over a surface {F = 0}, without a mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// A cube that may hold surface, with the function restricted to it.
struct SurfaceBlock {
  Aabb box;
  std::shared_ptr<const ImplicitSurface> surface;
};

/// Cubes of one size that together hold all of the surface inside `region`: whatever is left out
/// is free of surface, by ImplicitSurface::enclose. Halved until there are enough of them for
/// `samples` crossings with a lattice of at most kMostCellsPerBlock cells along an edge. Once
/// cancelled, blocks are missing.
std::vector<SurfaceBlock> surface_blocks(const ImplicitSurface& surface, const Aabb& region,
                                         std::size_t samples, std::uint64_t seed,
                                         const Progress* progress = nullptr);

/// The octants of a block that may hold surface, with restrictions of their own if `restrict_more`.
std::vector<SurfaceBlock> halved(const SurfaceBlock& block, bool restrict_more);

inline constexpr int kMostCellsPerBlock = 6;
/// Cells along the edge of a block for about `samples` crossings in all blocks.
int cells_per_block(std::size_t blocks, std::size_t samples);

/// Appends the crossings of the surface with the lattice lines of the block, `cells` along each
/// edge of it: points of the surface, to about 1e-10 of a cell or the rounding of F. Two crossings
/// between neighbouring nodes are missed.
void append_crossings(const SurfaceBlock& block, int cells, std::vector<Vec3d>& out);

}  // namespace cs2mesh
