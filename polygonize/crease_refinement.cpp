#include "polygonize/crease_refinement.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/part_contacts.h"
#include "polygonize/refine.h"

namespace cs2mesh {
namespace {

constexpr double kLeastShare = 1.0 / 8;

/// Of a part: the triangles that intersect others, and the smallest sin(a / 2) there.
struct Crease {
  std::vector<std::uint32_t> triangles;
  double share = 1.0;
};

/// sin(a / 2) for two triangles: half of a and half of the angle between the normals are 90 degrees
/// together.
double sine_of_half_angle(const TriangleMesh& a, std::size_t s, const TriangleMesh& b,
                          std::size_t t) {
  const Vec3d m = area_vector(a, s), n = area_vector(b, t);
  const double cosine = dot(m, n) / (norm(m) * norm(n));
  return cosine > -1 ? std::sqrt(0.5 * (1 + cosine)) : 0.0;  // 0 for triangles without area, too
}

std::vector<Crease> find_creases(const Model& model) {
  std::vector<Crease> creases(model.parts.size());
  for (const PartContact& contact : find_contacts(model)) {
    Crease& a = creases[contact.a];
    Crease& b = creases[contact.b];
    for (const auto& [s, t] : contact.triangles) {
      const double share = std::max(
          kLeastShare,
          sine_of_half_angle(model.parts[contact.a].mesh, s, model.parts[contact.b].mesh, t));
      a.triangles.push_back(s);
      b.triangles.push_back(t);
      a.share = std::min(a.share, share);
      b.share = std::min(b.share, share);
    }
  }
  return creases;
}

/// The triangles with a vertex in common with one of these, ascending.
std::vector<std::uint32_t> with_neighbours(const TriangleMesh& mesh,
                                           const std::vector<std::uint32_t>& triangles) {
  std::vector<char> touched(mesh.positions.size());
  for (const std::uint32_t t : triangles) {
    for (const auto v : mesh.triangles[t]) touched[v] = 1;
  }
  std::vector<std::uint32_t> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corner = mesh.triangles[t];
    if (touched[corner[0]] + touched[corner[1]] + touched[corner[2]] > 0) {
      found.push_back(static_cast<std::uint32_t>(t));
    }
  }
  return found;
}

}  // namespace

void refine_at_creases(std::span<const ImplicitSurface* const> surfaces, Model& model,
                       double tolerance, Progress* progress) {
  require(surfaces.size() == model.parts.size(), "refine_at_creases: a surface a part");
  const std::vector<Crease> creases = find_creases(model);
  for (std::size_t i = 0; i < creases.size(); ++i) {
    if (creases[i].triangles.empty()) continue;
    TriangleMesh& mesh = model.parts[i].mesh;
    const std::vector<std::uint32_t> around = with_neighbours(mesh, creases[i].triangles);
    RefineOptions options;
    options.tolerance = creases[i].share * tolerance;
    options.first_looked_at = &around;
    options.progress = progress;
    TriangleMesh finer = refine(*surfaces[i], mesh, options);
    // Refinement may fold a mesh where its surface has creases of its own.
    if (check(finer).ok()) mesh = std::move(finer);
  }
}

}  // namespace cs2mesh
