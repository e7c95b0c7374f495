#include "polygonize/attributes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libfield/base/check.h"
#include "libfield/base/color.h"

namespace cs2mesh {
namespace {

/// Vertices evaluated together: neighbours in the list, for which one restriction of the field
/// pays.
constexpr std::size_t kBatch = 1024;

Vec3d linear_color(const Color& color) {
  return {srgb_to_linear(color.r), srgb_to_linear(color.g), srgb_to_linear(color.b)};
}

std::vector<Vec3d> mean_face_normals(const TriangleMesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d area = area_vector(mesh, t);
    for (const auto vertex : mesh.triangles[t]) sums[vertex] += area;
  }
  return sums;
}

/// The unit vector along `v`, or false if it has no direction; scaled first, since a gradient may
/// be too small to be squared.
bool unit(const Vec3d& v, Vec3<float>& out) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !is_finite(v)) return false;
  out = Vec3<float>(normalized(v / largest));
  return true;
}

}  // namespace

void add_normals(TriangleMesh& mesh, const ImplicitSurface& surface) {
  const std::size_t count = mesh.positions.size();
  mesh.normals.assign(count, Vec3<float>(0, 0, 0));
  tbb::parallel_for(std::size_t{0}, (count + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t begin = batch * kBatch, end = std::min(begin + kBatch, count);
    const std::span<const Vec3d> points(mesh.positions.data() + begin, end - begin);
    Aabb box;
    for (const Vec3d& p : points) box.include(p);
    std::vector<Jet> jets(points.size());
    surface.restrict_to(box)->jets(points, jets);
    for (std::size_t i = begin; i < end; ++i) unit(-jets[i - begin].gradient, mesh.normals[i]);
  });

  // Fill in what the gradient left open.
  const Vec3<float> none(0, 0, 0);
  if (std::find(mesh.normals.begin(), mesh.normals.end(), none) == mesh.normals.end()) return;
  const std::vector<Vec3d> sums = mean_face_normals(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    if (mesh.normals[i] == none && !unit(sums[i], mesh.normals[i])) mesh.normals[i] = {0, 0, 1};
  }
}

void add_colors(TriangleMesh& mesh, const MaterialBlend& blend,
                const std::vector<Material>& materials) {
  std::vector<Vec3d> palette;
  palette.reserve(materials.size());
  for (const Material& material : materials) palette.push_back(linear_color(material.diffuse));
  mesh.colors.assign(mesh.positions.size(), Vec3<float>());
  const tbb::blocked_range<std::size_t> all(0, mesh.positions.size(), kBatch);
  tbb::parallel_for(all, [&](const tbb::blocked_range<std::size_t>& range) {
    std::vector<MaterialShare> shares;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      blend.shares(mesh.positions[i], shares);
      Vec3d sum;
      for (const MaterialShare& share : shares) {
        const auto index = static_cast<std::size_t>(share.material);
        require(index < palette.size(), "a share names a material that is not in the list");
        sum += share.share * palette[index];
      }
      mesh.colors[i] = Vec3<float>(max(Vec3d(), min(Vec3d(1, 1, 1), sum)));
    }
  });
}

}  // namespace cs2mesh
