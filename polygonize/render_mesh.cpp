#include "polygonize/render_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "libfield/base/check.h"
#include "libfield/ray/shading.h"
#include "polygonize/closest_point.h"

namespace cs2mesh {
namespace {

/// A part ready for rays.
struct Drawn {
  const TriangleMesh& mesh;
  ClosestPoint tree;
};

Vec3d color_of(const TriangleMesh& mesh, std::uint32_t triangle) {
  if (mesh.colors.size() != mesh.positions.size()) return {1, 1, 1};
  Vec3d sum{};
  for (const TriangleMesh::Index corner : mesh.triangles[triangle])
    sum += Vec3d(mesh.colors[corner]);
  return sum / 3.0;
}

Vec3d shade(const Drawn& drawn, std::uint32_t triangle, const Vec3d& point, const Vec3d& eye,
            const std::vector<Light>& lights) {
  const Vec3d area = area_vector(drawn.mesh, triangle);
  const double size = norm(area);
  if (!(size > 0)) return {};
  std::vector<Illumination> seen;
  for (const Light& light : lights) {
    const Vec3d way = light.position - point;
    const double distance = norm(way);
    if (distance > 0) seen.push_back({way / distance, light.intensity * linear_color(light.color)});
  }
  Reflectance flat;
  flat.diffuse = color_of(drawn.mesh, triangle);
  return phong(flat, area / size, eye, seen);
}

Vec3d look(const std::vector<Drawn>& parts, const Ray& ray, const std::vector<Light>& lights,
           const Vec3d& background) {
  double t = std::numeric_limits<double>::infinity();
  const Drawn* nearest = nullptr;
  for (const Drawn& part : parts) {
    const double at = part.tree.first_hit(ray.origin, ray.direction, 0, t);
    if (!(at < t)) continue;
    t = at;
    nearest = &part;
  }
  if (nearest == nullptr) return background;
  const Vec3d point = ray.at(t);
  const ClosestPoint::Hit hit = nearest->tree.nearest(point);
  return shade(*nearest, hit.triangle, point, -ray.direction, lights);
}

}  // namespace

ColorImage render_mesh(const Model& model, const Scene& scene, const View& view,
                       const RenderMeshOptions& options) {
  constexpr int kMostSide = 65536;
  require(options.width >= 1 && options.width <= kMostSide && options.height >= 1 &&
              options.height <= kMostSide &&
              static_cast<long long>(options.width) * options.height <= kMostPixels,
          "render_mesh: a picture of that size");
  require(options.samples >= 1 && options.samples <= 16, "render_mesh: 1 to 16 samples");
  std::vector<Drawn> parts;
  for (const MeshPart& part : model.parts) parts.push_back({part.mesh, ClosestPoint(part.mesh)});
  const std::vector<Light> lights = lights_of(scene, view.eye);
  const Vec3d background = linear_color(scene.background);
  ColorImage image(options.width, options.height);
  const int n = options.samples;
  tbb::parallel_for(0, options.height, [&](int y) {
    if (cancelled(options.progress)) return;
    for (int x = 0; x < options.width; ++x) {
      Vec3d sum{};
      for (int k = 0; k < n * n; ++k) {
        const Ray ray = view.ray((x + (k % n + 0.5) / n) / options.width,
                                 (y + (k / n + 0.5) / n) / options.height);
        sum += look(parts, ray, lights, background);
      }
      image.at(x, y) = Vec3<float>(sum / static_cast<double>(n * n));
    }
  });
  return image;
}

}  // namespace cs2mesh
