#include "polygonize/source_patches.h"

#include <limits>

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

void take_attributes(MeshPart& part, std::span<const SourcePatch> patches) {
  const std::size_t count = part.mesh.positions.size();
  part.mesh.colors = means(count, patches, &TriangleMesh::colors);
  part.mesh.normals = means(count, patches, &TriangleMesh::normals);
  for (Vec3<float>& normal : part.mesh.normals) {
    const double length = norm(Vec3d(normal));
    // Opposite normals, as where two solids touch, have no direction between them.
    normal = length > 1e-6 ? Vec3<float>(Vec3d(normal) / length) : Vec3<float>(0, 0, 1);
  }
}

}  // namespace cs2mesh
