#include "polygonize/attributes.h"

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

/// Runs f(index of the first, positions) for all batches of vertices in parallel.
template <class F>
void for_each_batch(const TriangleMesh& mesh, const F& f) {
  const std::size_t count = mesh.positions.size();
  tbb::parallel_for(std::size_t{0}, (count + kBatch - 1) / kBatch, [&](std::size_t batch) {
    const std::size_t begin = batch * kBatch, end = std::min(begin + kBatch, count);
    f(begin, std::span<const Vec3d>(mesh.positions.data() + begin, end - begin));
  });
}

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
  for_each_batch(mesh, [&](std::size_t begin, std::span<const Vec3d> points) {
    Aabb box;
    for (const Vec3d& p : points) box.include(p);
    std::vector<Jet> jets(points.size());
    surface.restrict_to(box)->jets(points, jets);
    for (std::size_t i = 0; i < points.size(); ++i) {
      unit(-jets[i].gradient, mesh.normals[begin + i]);
    }
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
  for_each_batch(mesh, [&](std::size_t begin, std::span<const Vec3d> points) {
    std::vector<Vec3d> colors(points.size());
    blend.blend(points, palette, colors);
    for (std::size_t i = 0; i < points.size(); ++i) {
      mesh.colors[begin + i] = Vec3<float>(max(Vec3d(), min(Vec3d(1, 1, 1), colors[i])));
    }
  });
}

}  // namespace cs2mesh
