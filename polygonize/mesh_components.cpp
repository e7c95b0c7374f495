#include "polygonize/mesh_components.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/disjoint_sets.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr Index kNone = std::numeric_limits<Index>::max();

/// The half of the solid angle under which a triangle is seen from `p`.
double half_solid_angle(const TriangleMesh& mesh, std::size_t triangle, const Vec3d& p) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d a = mesh.positions[t[0]] - p, b = mesh.positions[t[1]] - p,
              c = mesh.positions[t[2]] - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return std::atan2(dot(a, cross(b, c)),
                    la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

void measure(const TriangleMesh& mesh, MeshComponent& component) {
  for (const Index t : component.triangles) {
    for (const Index v : mesh.triangles[t]) component.box.include(mesh.positions[v]);
  }
  // Volume about the middle of the box: the origin may be far away.
  const Vec3d o = component.box.center();
  double volume = 0, size = 0;
  for (const Index t : component.triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3d& p = mesh.positions[a];
    const Vec3d normal = area_vector(mesh, t);
    component.area += norm(normal);
    volume += dot(p - o, normal) / 3;
    size += norm(p - o) * norm(mesh.positions[b] - p) * norm(mesh.positions[c] - p);
  }
  component.volume = volume;
  // Differences of coordinates round by 2^-53 of themselves, and so does each step from there to a
  // term and each term that is added: less than so many steps of 2^-53 of the terms' sizes.
  const double steps = static_cast<double>(component.triangles.size()) + 16;
  component.inwards = volume < -0x1p-53 * steps * size;
}

}  // namespace

std::vector<MeshComponent> components(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) sets.join(a, b), sets.join(a, c);
  std::vector<Index> number(mesh.positions.size(), kNone);
  std::vector<MeshComponent> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Index& n = number[sets.root(mesh.triangles[t][0])];
    if (n == kNone) {
      n = static_cast<Index>(found.size());
      found.emplace_back();
    }
    found[n].triangles.push_back(static_cast<Index>(t));
  }
  for (MeshComponent& component : found) measure(mesh, component);
  return found;
}

double winding_number(const TriangleMesh& mesh, const Vec3d& p) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += half_solid_angle(mesh, t, p);
  return sum / (2 * std::numbers::pi);
}

double winding_number(const TriangleMesh& mesh, const MeshComponent& component, const Vec3d& p) {
  double sum = 0;
  for (const Index t : component.triangles) sum += half_solid_angle(mesh, t, p);
  return sum / (2 * std::numbers::pi);
}

void append_triangles(TriangleMesh& to, const TriangleMesh& mesh,
                      const std::vector<Index>& chosen) {
  std::vector<Index> number(mesh.positions.size(), kNone);
  for (const Index t : chosen) {
    auto& triangle = to.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = mesh.triangles[t][k];
      if (number[v] == kNone) {
        number[v] = static_cast<Index>(to.positions.size());
        to.positions.push_back(mesh.positions[v]);
      }
      triangle[k] = number[v];
    }
  }
}

void keep_triangles(TriangleMesh& mesh, const std::vector<char>& kept) {
  require(kept.size() == mesh.triangles.size(), "keep_triangles: one mark a triangle");
  std::vector<Index> chosen;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (kept[t] != 0) chosen.push_back(static_cast<Index>(t));
  }
  TriangleMesh rest;
  append_triangles(rest, mesh, chosen);
  mesh = std::move(rest);
}

}  // namespace cs2mesh
