#include "polygonize/compare.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "libfield/ray/bound_tree.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/ray_solver.h"
#include "polygonize/closest_point.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// For each part of the scene the mesh of its name; empty unless the names are the same.
std::vector<const TriangleMesh*> matched(const CompiledScene& compiled, const Model& model) {
  std::vector<const TriangleMesh*> meshes;
  std::set<std::string> used;
  for (const Part& part : compiled.parts) {
    const auto same = std::find_if(model.parts.begin(), model.parts.end(),
                                   [&](const MeshPart& mesh) { return mesh.name == part.name; });
    if (same == model.parts.end() || !used.insert(part.name).second) return {};
    meshes.push_back(&same->mesh);
  }
  return meshes.size() == model.parts.size() ? meshes : std::vector<const TriangleMesh*>{};
}

void take_worse(double value, const Vec3d& at, double& worst, Vec3d& worst_at) {
  if (value > worst) {
    worst = value;
    worst_at = at;
  }
}

MeasuredError total_of(const std::vector<PartComparison>& parts) {
  MeasuredError total;
  double squares = 0, angles = 0;
  for (const PartComparison& part : parts) {
    const MeasuredError& e = part.error;
    take_worse(e.mesh_to_surface_max, e.mesh_to_surface_at, total.mesh_to_surface_max,
               total.mesh_to_surface_at);
    take_worse(e.surface_to_mesh_max, e.surface_to_mesh_at, total.surface_to_mesh_max,
               total.surface_to_mesh_at);
    take_worse(e.normal_deg_max, e.normal_deg_at, total.normal_deg_max, total.normal_deg_at);
    total.p999 = std::max(total.p999, e.p999);
    squares += e.rms * e.rms * static_cast<double>(e.mesh_samples + e.surface_samples);
    angles += e.normal_deg_mean * static_cast<double>(e.mesh_samples);
    total.mesh_samples += e.mesh_samples;
    total.surface_samples += e.surface_samples;
    total.ray_samples += e.ray_samples;
    total.uncertain_rays += e.uncertain_rays;
    total.complete = total.complete && e.complete;
  }
  const auto samples = static_cast<double>(total.mesh_samples + total.surface_samples);
  if (samples > 0) total.rms = std::sqrt(squares / samples);
  if (total.mesh_samples > 0) {
    total.normal_deg_mean = angles / static_cast<double>(total.mesh_samples);
  }
  return total;
}

/// One pixel: whether surface and mesh cover it.
enum class Cover : char { neither, both, one, uncertain };

Cover cover(const std::deque<BoundTree>& parts, const ClosestPoint& mesh_tree, const Ray& ray) {
  bool surface = false, uncertain = false;
  for (const BoundTree& part : parts) {
    const RayHit hit = first_hit(part, ray, 0, kInfinity);
    surface = surface || hit.status == RayStatus::hit;
    uncertain = uncertain || hit.status == RayStatus::uncertain;
    if (surface) break;
  }
  if (!surface && uncertain) return Cover::uncertain;
  const bool mesh = mesh_tree.first_hit(ray.origin, ray.direction, 0, kInfinity) < kInfinity;
  return surface != mesh ? Cover::one : surface ? Cover::both : Cover::neither;
}

void compare_silhouettes(const CompiledScene& compiled, const Scene& scene,
                         const TriangleMesh& mesh, const CompareOptions& options,
                         CompareReport& report) {
  const Camera& camera = scene.camera;
  const int longer = std::max({camera.width, camera.height, 1});
  const double scale = std::min(1.0, static_cast<double>(options.largest_picture) / longer);
  const int width = std::max(1, static_cast<int>(std::lround(camera.width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(camera.height * scale)));
  const View view = make_view(camera, compiled.extent, width, height);
  const ClosestPoint tree(mesh);
  std::deque<BoundTree> parts;
  for (const Part& part : compiled.parts) parts.emplace_back(*part.surface);
  std::vector<Cover> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  tbb::parallel_for(0, height, [&](int j) {
    if (cancelled(options.progress)) return;
    for (int i = 0; i < width; ++i) {
      const Ray ray = view.ray((i + 0.5) / width, (j + 0.5) / height);
      pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(i)] = cover(parts, tree, ray);
    }
  });
  const auto count = [&](Cover kind) {
    return static_cast<std::size_t>(std::count(pixels.begin(), pixels.end(), kind));
  };
  report.uncertain_pixels = count(Cover::uncertain);
  report.silhouette_pixels = count(Cover::one) + count(Cover::both);
  if (report.silhouette_pixels > 0) {
    report.silhouette_xor =
        static_cast<double>(count(Cover::one)) / static_cast<double>(report.silhouette_pixels);
  }
}

}  // namespace

Result<CompareReport> compare(const CompiledScene& compiled, const Scene& scene, const Model& model,
                              const CompareOptions& options) {
  if (model.triangle_count() == 0) {
    return error_at({}, "the mesh has no triangles, so there is nothing to compare");
  }
  const TriangleMesh all = joined(model);
  const std::vector<const TriangleMesh*> meshes = matched(compiled, model);
  MeasureOptions measuring;
  measuring.seed = options.seed;
  measuring.mesh_to_surface = options.mesh_to_surface;
  measuring.progress = options.progress;
  CompareReport report;
  if (!meshes.empty()) {
    // Samples go to the parts in proportion to their triangles' number, with a floor for small
    // ones.
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const double share = static_cast<double>(meshes[i]->triangles.size()) /
                           static_cast<double>(all.triangles.size());
      const auto portion = [&](std::size_t whole) {
        return static_cast<std::size_t>(std::max(share, 0.01) * static_cast<double>(whole));
      };
      measuring.samples = portion(options.samples);
      measuring.certified_rays = portion(options.certified_rays);
      report.parts.push_back(
          {compiled.parts[i].name, measure(*compiled.parts[i].surface, *meshes[i], measuring)});
    }
  } else {
    std::vector<const ImplicitSurface*> surfaces;
    for (const Part& part : compiled.parts) surfaces.push_back(part.surface.get());
    measuring.samples = options.samples;
    measuring.certified_rays = options.certified_rays;
    report.parts.push_back({"", measure(surfaces, all, measuring)});
  }
  report.total = total_of(report.parts);
  if (options.silhouette) compare_silhouettes(compiled, scene, all, options, report);
  if (!report.total.complete || cancelled(options.progress)) {
    return error_at({}, "interrupted", Failure::interrupted);
  }
  return report;
}

}  // namespace cs2mesh
