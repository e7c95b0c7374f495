// What a united mesh is made of, so that each piece gets the attributes of its own part.
#pragma once

#include <string>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// One for each source that any triangle is of, ascending; none for a part by itself. A vertex on a
/// crease is in several.
std::vector<SourcePatch> split_by_source(const MeshPart& part);

/// The united part that these are the patches of, one a source in their order: vertices of
/// different patches at equal positions become one. Their `vertex` is set here.
MeshPart join_patches(std::vector<std::string> sources, std::vector<SourcePatch> patches);

/// Gives the part these patches, and the united mesh their attributes where they all have them: at
/// a crease the mean of the colours, and the direction halfway between the normals.
void take_attributes(MeshPart& part, std::vector<SourcePatch> patches);

}  // namespace cs2mesh
