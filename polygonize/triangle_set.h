// A set of triangles, each known by the places of its corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The same for triangles of the same corners in the same turn, whatever meshes they are of and
/// whichever corner comes first; another for any other triangle, but for odds of 2^-64.
std::uint64_t triangle_key(const TriangleMesh& mesh, std::size_t triangle);

/// Tells which triangles of a mesh are as they were, after others have been changed and all have
/// been given new numbers.
class TriangleSet {
 public:
  TriangleSet() = default;
  /// All triangles of a mesh. O(n log n).
  explicit TriangleSet(const TriangleMesh& mesh);

  bool empty() const { return keys_.empty(); }
  /// O(log n).
  bool contains(std::uint64_t key) const;
  /// The numbers of the triangles of a mesh that are not in the set, in ascending order.
  std::vector<std::uint32_t> others(const TriangleMesh& mesh) const;
  /// Keys may be in the set already. O(n + k log k).
  void add(std::vector<std::uint64_t> keys);
  /// Keys that are not in the set do no harm. O(n + k log k).
  void remove(std::vector<std::uint64_t> keys);

 private:
  std::vector<std::uint64_t> keys_;  ///< ascending
};

}  // namespace cs2mesh
