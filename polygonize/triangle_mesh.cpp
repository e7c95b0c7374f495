#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

std::size_t Model::vertex_count() const {
  std::size_t count = 0;
  for (const MeshPart& part : parts) count += part.mesh.positions.size();
  return count;
}

std::size_t Model::triangle_count() const {
  std::size_t count = 0;
  for (const MeshPart& part : parts) count += part.mesh.triangles.size();
  return count;
}

TriangleMesh joined(const Model& model) {
  TriangleMesh all;
  for (const MeshPart& part : model.parts) {
    const auto base = static_cast<TriangleMesh::Index>(all.positions.size());
    all.positions.insert(all.positions.end(), part.mesh.positions.begin(),
                         part.mesh.positions.end());
    for (const auto& [a, b, c] : part.mesh.triangles) {
      all.triangles.push_back({a + base, b + base, c + base});
    }
  }
  return all;
}

Aabb bounds(const TriangleMesh& mesh) {
  Aabb box;
  for (const Vec3d& p : mesh.positions) box.include(p);
  return box;
}

Aabb bounds(const TriangleMesh& mesh, std::size_t triangle) {
  Aabb box;
  for (const TriangleMesh::Index v : mesh.triangles[triangle]) box.include(mesh.positions[v]);
  return box;
}

Vec3d centroid(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
}

Vec3d area_vector(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3d& origin = mesh.positions[a];
  return 0.5 * cross(mesh.positions[b] - origin, mesh.positions[c] - origin);
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) sum += norm(area_vector(mesh, i));
  return sum;
}

double volume(const TriangleMesh& mesh) {
  if (mesh.empty()) return 0;
  // Tetrahedra from a vertex of the mesh: far from the origin, those from the origin would cancel.
  const Vec3d apex = mesh.positions[mesh.triangles[0][0]];
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    sum += dot(mesh.positions[mesh.triangles[i][0]] - apex, area_vector(mesh, i));
  }
  return sum / 3;
}

}  // namespace cs2mesh
