#include "polygonize/source_patches.h"

#include <array>
#include <limits>
#include <map>
#include <span>
#include <utility>

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
using Attribute = std::vector<Vec3<float>>;

/// For each vertex of the part, the mean over the patches that it is in.
Attribute means(std::size_t count, std::span<const SourcePatch> patches,
                Attribute TriangleMesh::*attribute) {
  std::vector<Vec3d> sum(count);
  std::vector<int> terms(count);
  for (const SourcePatch& patch : patches) {
    const Attribute& values = patch.mesh.*attribute;
    if (values.size() != patch.vertex.size()) return {};
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum[patch.vertex[i]] += Vec3d(values[i]);
      ++terms[patch.vertex[i]];
    }
  }
  Attribute mean(count);
  for (std::size_t v = 0; v < count; ++v) {
    if (terms[v] > 0) mean[v] = Vec3<float>(sum[v] / static_cast<double>(terms[v]));
  }
  return mean;
}

}  // namespace

std::vector<SourcePatch> split_by_source(const MeshPart& part) {
  constexpr Index kNone = std::numeric_limits<Index>::max();
  std::vector<SourcePatch> patches;
  if (part.sources.empty()) return patches;
  std::vector<Index> number(part.mesh.positions.size(), kNone);
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    if (patches.empty() || patches.back().source != part.source_of[t]) {
      if (!patches.empty()) {
        for (const Index v : patches.back().vertex) number[v] = kNone;
      }
      patches.emplace_back().source = part.source_of[t];
    }
    SourcePatch& patch = patches.back();
    auto& triangle = patch.mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = part.mesh.triangles[t][k];
      if (number[v] == kNone) {
        number[v] = static_cast<Index>(patch.vertex.size());
        patch.vertex.push_back(v);
        patch.mesh.positions.push_back(part.mesh.positions[v]);
      }
      triangle[k] = number[v];
    }
  }
  return patches;
}

MeshPart join_patches(std::vector<std::string> sources, std::vector<SourcePatch> patches) {
  /// A vertex of the part, and the last patch that it is in.
  struct Place {
    Index vertex = 0;
    std::size_t patch = 0;
  };
  MeshPart part;
  std::map<std::array<double, 3>, Place> places;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    SourcePatch& patch = patches[i];
    for (const Vec3d& p : patch.mesh.positions) {
      const auto fresh = static_cast<Index>(part.mesh.positions.size());
      const auto [at, is_new] = places.try_emplace({p.x, p.y, p.z}, Place{fresh, i});
      // Two of one patch stay two: they are no seam, but something to be found by a check.
      if (!is_new && at->second.patch == i) at->second.vertex = fresh;
      at->second.patch = i;
      if (at->second.vertex == fresh) part.mesh.positions.push_back(p);
      patch.vertex.push_back(at->second.vertex);
    }
    for (const auto& [a, b, c] : patch.mesh.triangles) {
      part.mesh.triangles.push_back({patch.vertex[a], patch.vertex[b], patch.vertex[c]});
      part.source_of.push_back(static_cast<std::uint32_t>(patch.source));
    }
  }
  part.sources = std::move(sources);
  take_attributes(part, std::move(patches));
  return part;
}

void take_attributes(MeshPart& part, std::vector<SourcePatch> patches) {
  const std::size_t count = part.mesh.positions.size();
  part.mesh.colors = means(count, patches, &TriangleMesh::colors);
  part.mesh.normals = means(count, patches, &TriangleMesh::normals);
  for (Vec3<float>& normal : part.mesh.normals) {
    const double length = norm(Vec3d(normal));
    // Opposite normals, as where two solids touch, have no direction between them.
    normal = length > 1e-6 ? Vec3<float>(Vec3d(normal) / length) : Vec3<float>(0, 0, 1);
  }
  part.patches = std::move(patches);
}

}  // namespace cs2mesh
