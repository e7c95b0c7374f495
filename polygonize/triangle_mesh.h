// Triangle meshes as they leave the mesher and enter the writers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libfield/base/aabb.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

/// Indexed triangles, counter-clockwise seen from outside. Attributes are empty or one a vertex.
struct TriangleMesh {
  using Index = std::uint32_t;
  std::vector<Vec3d> positions;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Vec3<float>> normals;  ///< unit, outward
  std::vector<Vec3<float>> colors;   ///< linear RGB, 0..1

  bool empty() const { return triangles.empty(); }
};

/// The triangles of one source of a united mesh, open along creases.
struct SourcePatch {
  std::size_t source = 0;  ///< index into the part's `sources`
  TriangleMesh mesh;
  std::vector<TriangleMesh::Index> vertex;  ///< for each vertex, the number in the united mesh
};

/// A mesh with the name of the part of the scene that it bounds, or of several united.
struct MeshPart {
  std::string name;
  TriangleMesh mesh;
  /// Of a union, what it was made of: names, and for each triangle the number of the one whose
  /// surface it shows, ascending. Both are empty for a part by itself.
  std::vector<std::string> sources{};
  std::vector<std::uint32_t> source_of{};
  /// Each source's triangles with its own attributes, for formats that can have several of them at
  /// a crease; empty for a part by itself, and for a union without attributes.
  std::vector<SourcePatch> patches{};
};

/// What one output file holds: a closed mesh for each part.
struct Model {
  std::vector<MeshPart> parts;

  std::size_t vertex_count() const;
  std::size_t triangle_count() const;
};

/// The parts as one mesh, one after the other, without attributes.
TriangleMesh joined(const Model& model);

Aabb bounds(const TriangleMesh& mesh);
Aabb bounds(const TriangleMesh& mesh, std::size_t triangle);
Vec3d centroid(const TriangleMesh& mesh, std::size_t triangle);
/// Half the cross product of two edges: the normal times the area.
Vec3d area_vector(const TriangleMesh& mesh, std::size_t triangle);
double area(const TriangleMesh& mesh);
/// Enclosed volume of a closed mesh; negative when it is wound inwards.
double volume(const TriangleMesh& mesh);

}  // namespace cs2mesh
