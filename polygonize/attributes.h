// What a mesh carries besides its shape, taken from the exact field.
#pragma once

#include <vector>

#include "libfield/field/compile.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Sets the unit outward normals of all vertices: -grad F normalised, and where the gradient
/// vanishes (or is no number) the mean of the adjoining triangles' normals by area; +z where that
/// vanishes too. One jet a vertex, in parallel.
void add_normals(TriangleMesh& mesh, const ImplicitSurface& surface);

/// Sets the colours of all vertices: the diffuse colours of the materials, mixed as linear light by
/// the shares that `blend` gives at the vertex (thesis, equation 4.12). Shares name indices into
/// `materials`. In parallel.
void add_colors(TriangleMesh& mesh, const MaterialBlend& blend,
                const std::vector<Material>& materials);

}  // namespace cs2mesh
