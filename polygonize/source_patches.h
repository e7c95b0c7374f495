// What a united mesh is made of, so that each piece gets the attributes of its own part.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The triangles of one source, open along creases.
struct SourcePatch {
  std::size_t source = 0;  ///< index into the part's `sources`
  TriangleMesh mesh;
  std::vector<TriangleMesh::Index> vertex;  ///< for each vertex, the number in the united mesh
};

/// One for each source that any triangle is of, ascending; none for a part by itself. A vertex on a
/// crease is in several.
std::vector<SourcePatch> split_by_source(const MeshPart& part);

/// Gives the part the attributes of its patches, where they all have them: at a crease the mean of
/// the colours, and the direction halfway between the normals.
void take_attributes(MeshPart& part, std::span<const SourcePatch> patches);

}  // namespace cs2mesh
