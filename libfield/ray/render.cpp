#include "libfield/ray/render.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "libfield/ray/shading.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTile = 16;  // pixels a side that one thread does

/// The surface that a ray meets first.
struct Sight {
  const Part* part = nullptr;  ///< none: the background
  double t = kInfinity;
  double t_error = 0.0;
};

/// All that is the same for every pixel.
class Tracer {
 public:
  Tracer(const CompiledScene& compiled, const Scene& scene, const View& view,
         const RenderOptions& options, std::size_t tree_cells);

  struct Sample {
    Vec3d color;  ///< linear, 0..1
    double depth = kInfinity;
    Vec3d normal;
    std::uint64_t jets = 0;
  };
  Sample trace(const Ray& ray, RenderStatistics& statistics) const;
  std::uint64_t tree_bounds() const {
    std::uint64_t sum = 0;
    for (const BoundTree& tree : trees_) sum += tree.bounds_taken();
    return sum;
  }

 private:
  Sight look(const Ray& ray, RayCost& cost, std::uint64_t& uncertain) const;
  std::optional<RayHit> meet(const BoundTree& tree, const Ray& ray, RayRange range,
                             const RaySolverOptions& solver, RayCost& cost,
                             std::uint64_t& uncertain) const;
  bool in_shadow(const Vec3d& point, const Vec3d& light, RenderStatistics& statistics) const;
  Vec3d shade(const Sight& sight, const Vec3d& point, const Vec3d& normal, const Vec3d& eye,
              RenderStatistics& statistics) const;

  const CompiledScene& compiled_;
  const Scene& scene_;
  const RenderOptions& options_;
  std::vector<BoundTree> trees_;  // one a part
  std::vector<Light> lights_;
  Vec3d background_;
  double size_ = 1.0;  // a length scale of the scene
};

Tracer::Tracer(const CompiledScene& compiled, const Scene& scene, const View& view,
               const RenderOptions& options, std::size_t tree_cells)
    : compiled_(compiled),
      scene_(scene),
      options_(options),
      lights_(lights_of(scene, view.eye)),
      background_(linear_color(scene.background)) {
  if (compiled.extent.finite() && compiled.extent.diagonal() > 0.0) {
    size_ = compiled.extent.diagonal();
  }
  trees_.reserve(compiled.parts.size());
  for (const Part& part : compiled.parts) trees_.emplace_back(*part.surface, tree_cells);
}

/// The first crossing. Uncertain places are counted and passed over, unless what follows is a way
/// out: then the way in was there.
std::optional<RayHit> Tracer::meet(const BoundTree& tree, const Ray& ray, RayRange range,
                                   const RaySolverOptions& solver, RayCost& cost,
                                   std::uint64_t& uncertain) const {
  std::optional<RayHit> doubtful;
  for (int places = 0; places < 16; ++places) {
    const RayHit hit = first_hit(tree, ray, range.t0, range.t1, solver, &cost);
    if (hit.status == RayStatus::miss) return std::nullopt;
    if (hit.status == RayStatus::hit) return doubtful && !hit.entering ? doubtful : hit;
    ++uncertain;
    doubtful = hit;
    const double next = hit.t + hit.t_error;
    if (!std::isfinite(next) || !(next > range.t0) || !(next < range.t1)) return std::nullopt;
    range.t0 = next;
  }
  return std::nullopt;
}

Sight Tracer::look(const Ray& ray, RayCost& cost, std::uint64_t& uncertain) const {
  Sight sight;
  for (std::size_t i = 0; i < compiled_.parts.size(); ++i) {
    const std::optional<RayHit> hit =
        meet(trees_[i], ray, {0.0, sight.t}, options_.solver, cost, uncertain);
    // Where two parts agree to rounding the first in the scene is seen.
    if (hit && hit->t < sight.t) sight = {&compiled_.parts[i], hit->t, hit->t_error};
  }
  return sight;
}

bool Tracer::in_shadow(const Vec3d& point, const Vec3d& light, RenderStatistics& statistics) const {
  const Vec3d way = light - point;
  const double distance = norm(way);
  if (!(distance > 0.0)) return false;
  ++statistics.shadow_rays;
  // Only whether there is a crossing matters, not where.
  RaySolverOptions solver = options_.solver;
  solver.accuracy = 1e-6 * size_;
  const Ray ray{point, way / distance};
  for (const BoundTree& tree : trees_) {
    if (meet(tree, ray, {0.0, distance}, solver, statistics.shadow_cost,
             statistics.shadow_uncertain)) {
      return true;
    }
  }
  return false;
}

Vec3d Tracer::shade(const Sight& sight, const Vec3d& point, const Vec3d& normal, const Vec3d& eye,
                    RenderStatistics& statistics) const {
  std::vector<MaterialShare> shares;
  sight.part->materials->shares(point, shares);
  const Reflectance reflectance = blend(scene_, shares);
  // Shadow rays start off the surface by more than the error of the point.
  const Vec3d start = point + (1e-7 * size_ + 8.0 * sight.t_error) * normal;
  std::vector<Illumination> lights;
  for (const Light& light : lights_) {
    const Vec3d way = light.position - point;
    const double distance = norm(way);
    if (!(distance > 0.0) || !(dot(way, normal) > 0.0)) continue;
    if (light.shadow && in_shadow(start, light.position, statistics)) continue;
    lights.push_back({way / distance, light.intensity * linear_color(light.color)});
  }
  return phong(reflectance, normal, eye, lights);
}

/// A colour that can be shown; NaN, which a broken material could make, becomes black.
Vec3d shown(const Vec3d& color) {
  const auto channel = [](double c) { return c > 0.0 ? std::min(c, 1.0) : 0.0; };
  return {channel(color.x), channel(color.y), channel(color.z)};
}

Tracer::Sample Tracer::trace(const Ray& ray, RenderStatistics& statistics) const {
  RayCost cost;
  const Sight sight = look(ray, cost, statistics.uncertain);
  Sample sample;
  sample.jets = cost.jets;
  if (!sight.part) {
    ++statistics.misses;
    statistics.miss_cost += cost;
    sample.color = shown(background_);
    return sample;
  }
  ++statistics.hits;
  statistics.hit_cost += cost;
  const Vec3d point = ray.at(sight.t);
  const Vec3d gradient = sight.part->surface->jet(point).gradient;
  const double steepness = norm(gradient);
  sample.normal = steepness > 0.0 ? gradient / -steepness : -ray.direction;
  sample.depth = sight.t;
  // From within, the inner side is seen.
  const bool within = dot(sample.normal, ray.direction) > 0.0;
  const Vec3d facing = within ? -sample.normal : sample.normal;
  sample.color = shown(shade(sight, point, facing, -ray.direction, statistics));
  return sample;
}

/// The picture cut into squares, each done by one thread.
class Tiles {
 public:
  Tiles(int width, int height, Progress* progress)
      : width_(width),
        height_(height),
        columns_((width + kTile - 1) / kTile),
        rows_((height + kTile - 1) / kTile),
        progress_(progress) {}

  /// Calls pixel(x, y, statistics) for every pixel that is `wanted`. False if cancelled.
  template <class Wanted, class Pixel>
  bool for_each_pixel(const char* stage, RenderStatistics& sum, const Wanted& wanted,
                      const Pixel& pixel) const {
    const int count = columns_ * rows_;
    std::vector<RenderStatistics> by_tile(static_cast<std::size_t>(count));
    std::atomic<int> done{0};
    std::atomic<bool> cancelled{false};
    tbb::parallel_for(0, count, [&](int tile) {
      if (cancelled.load(std::memory_order_relaxed)) return;
      const int x0 = tile % columns_ * kTile;
      const int y0 = tile / columns_ * kTile;
      RenderStatistics& statistics = by_tile[static_cast<std::size_t>(tile)];
      for (int y = y0; y < std::min(height_, y0 + kTile); ++y) {
        for (int x = x0; x < std::min(width_, x0 + kTile); ++x) {
          if (wanted(x, y)) pixel(x, y, statistics);
        }
      }
      const int finished = ++done;
      if (!progress_) return;
      progress_->report(stage, static_cast<double>(finished) / count);
      if (progress_->cancelled()) cancelled = true;
    });
    for (const RenderStatistics& statistics : by_tile) sum += statistics;
    return !cancelled;
  }

 private:
  int width_, height_, columns_, rows_;
  Progress* progress_;
};

bool differ(const Vec3<float>& a, const Vec3<float>& b, const std::array<double, 3>& contrast) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double difference = std::abs(static_cast<double>(a[c]) - b[c]);
    if (difference > contrast[c] * (static_cast<double>(a[c]) + b[c])) return true;
  }
  return false;
}

/// Whether the pixel differs from one of its eight neighbours.
bool stands_out(const ColorImage& image, int x, int y, const std::array<double, 3>& contrast) {
  for (int v = std::max(0, y - 1); v <= std::min(image.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(image.width() - 1, x + 1); ++u) {
      if (differ(image.at(x, y), image.at(u, v), contrast)) return true;
    }
  }
  return false;
}

struct Frame {
  int width = 0, height = 0, samples = 1;
};

Result<Frame> frame_of(const Scene& scene, const RenderOptions& options) {
  const Frame frame{options.width.value_or(scene.camera.width),
                    options.height.value_or(scene.camera.height),
                    options.samples.value_or(scene.camera.samples)};
  const SourceLocation where{scene.file, 0, 0};
  constexpr int kLongestSide = 65536;
  if (frame.width < 1 || frame.height < 1 || frame.width > kLongestSide ||
      frame.height > kLongestSide) {
    return error_at(where, "an image is 1 to 65536 pixels wide and high");
  }
  if (frame.samples < 1 || frame.samples > 16) {
    return error_at(where, "a pixel has 1 to 16 samples a side");
  }
  if (static_cast<long long>(frame.width) * frame.height > kMostPixels) {
    return error_at(where, "an image has at most " + std::to_string(kMostPixels) + " pixels",
                    Failure::limit);
  }
  return frame;
}

}  // namespace

RenderStatistics& RenderStatistics::operator+=(const RenderStatistics& other) {
  hits += other.hits;
  misses += other.misses;
  shadow_rays += other.shadow_rays;
  uncertain += other.uncertain;
  shadow_uncertain += other.shadow_uncertain;
  hit_cost += other.hit_cost;
  miss_cost += other.miss_cost;
  shadow_cost += other.shadow_cost;
  return *this;
}

Result<RenderedImage> render(const CompiledScene& compiled, const Scene& scene,
                             const RenderOptions& options) {
  const Result<Frame> checked = frame_of(scene, options);
  if (!checked) return Result<RenderedImage>::failure(checked.diagnostics());
  const Frame frame = *checked;
  const View view = options.view
                        ? *options.view
                        : make_view(scene.camera, compiled.extent, frame.width, frame.height);
  // Cells pay by the rays that share them.
  const long long rays = static_cast<long long>(frame.width) * frame.height * frame.samples;
  const auto tree_cells = static_cast<std::size_t>(std::clamp(rays / 2, 5000LL, 400000LL));
  const Tracer tracer(compiled, scene, view, options, tree_cells);
  const Tiles tiles(frame.width, frame.height, options.progress);
  const auto interrupted = [] {
    return error_at({}, "interrupted while rendering", Failure::interrupted);
  };

  // One ray through the centre of every pixel.
  RenderedImage image;
  image.statistics.tree_bounds = tracer.tree_bounds();
  image.color = ColorImage(frame.width, frame.height);
  if (options.depth) image.depth = ScalarImage(frame.width, frame.height);
  if (options.normal) image.normal = ColorImage(frame.width, frame.height);
  if (options.cost) image.cost = ScalarImage(frame.width, frame.height);
  const auto all = [](int, int) { return true; };
  const auto center = [&](int x, int y, RenderStatistics& statistics) {
    const Ray ray = view.ray((x + 0.5) / frame.width, (y + 0.5) / frame.height);
    const Tracer::Sample sample = tracer.trace(ray, statistics);
    image.color.at(x, y) = Vec3<float>(sample.color);
    if (options.depth) image.depth.at(x, y) = static_cast<float>(sample.depth);
    if (options.normal) image.normal.at(x, y) = Vec3<float>(sample.normal);
    if (options.cost) image.cost.at(x, y) = static_cast<float>(sample.jets);
  };
  if (!tiles.for_each_pixel("render", image.statistics, all, center)) return interrupted();
  if (frame.samples == 1) return image;

  // More rays where a pixel stands out, judged by the first ones alone so that order is no matter.
  const ColorImage first = image.color;
  const int n = frame.samples;
  const auto edge = [&](int x, int y) { return stands_out(first, x, y, options.contrast); };
  const auto refine = [&](int x, int y, RenderStatistics& statistics) {
    Vec3d sum;
    for (int k = 0; k < n * n; ++k) {
      const double u = (x + (k % n + 0.5) / n) / frame.width;
      const double v = (y + (k / n + 0.5) / n) / frame.height;
      sum += tracer.trace(view.ray(u, v), statistics).color;
    }
    image.color.at(x, y) = Vec3<float>(sum / static_cast<double>(n * n));
  };
  if (!tiles.for_each_pixel("refine edges", image.statistics, edge, refine)) return interrupted();
  return image;
}

}  // namespace cs2mesh
