// A program of somebody else over the installed libraries.
#include <cmath>

#include "libfield/base/affine.h"
#include "polygonize/triangle_mesh.h"

int main() {
  // A tetrahedron turned by a quarter keeps its volume of 1/6.
  cs2mesh::TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const cs2mesh::Affine turn = cs2mesh::Affine::rotate({0, 0, 1}, 90);
  for (cs2mesh::Vec3d& p : mesh.positions) p = turn(p);
  return std::abs(cs2mesh::volume(mesh) - 1.0 / 6.0) < 1e-12 ? 0 : 1;
}
