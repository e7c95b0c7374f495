#include "polygonize/metrology.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/ray/bound_tree.h"
#include "libfield/ray/ray_solver.h"
#include "polygonize/closest_point.h"
#include "polygonize/surface_projection.h"
#include "polygonize/surface_samples.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kTrianglesPerBatch = 384;
constexpr std::size_t kSamplesPerBatch = 1024;
constexpr std::size_t kRaysPerBatch = 32;

struct Peak {
  double value = 0;
  Vec3d at;

  void take(double candidate, const Vec3d& place) {
    // The first of equals, so that the order of merging decides, not the threads.
    if (candidate > value) *this = {candidate, place};
  }
};

/// What one batch found; batches are merged in their order.
struct Tally {
  Peak distance, angle;
  double squares = 0, angle_sum = 0;
  std::size_t angles = 0, uncertain = 0;
  std::vector<float> distances;

  void add(double d, const Vec3d& place) {
    distance.take(d, place);
    squares += d * d;
    distances.push_back(static_cast<float>(d));
  }
  void merge(const Tally& other) {
    distance.take(other.distance.value, other.distance.at);
    angle.take(other.angle.value, other.angle.at);
    squares += other.squares;
    angle_sum += other.angle_sum;
    angles += other.angles;
    uncertain += other.uncertain;
    distances.insert(distances.end(), other.distances.begin(), other.distances.end());
  }
};

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

/// Points on the mesh, for some of them the normal of their triangle (else 0).
struct Samples {
  std::vector<Vec3d> points, normals;

  void add(const Vec3d& point, const Vec3d& normal = {}) {
    points.push_back(point);
    normals.push_back(normal);
  }
};

class Measurement {
 public:
  Measurement(std::span<const ImplicitSurface* const> surfaces, const TriangleMesh& mesh,
              const MeasureOptions& options)
      : surfaces_(surfaces), mesh_(mesh), options_(options), tree_(mesh) {
    Aabb reach = bounds(mesh);
    for (const ImplicitSurface* surface : surfaces_) {
      const Aabb box = surface->bounds();
      if (!box.empty() && box.finite()) reach.include(box);
    }
    search_limit_ = 2 * reach.diagonal();
  }

  MeasuredError run() {
    Tally forth;
    if (options_.mesh_to_surface) forth = mesh_to_surface();
    Tally back;
    if (options_.surface_to_mesh) {
      back = surface_to_mesh();
      result_.surface_samples = back.distances.size();
      Tally rays = certified_rays();
      result_.ray_samples = rays.distances.size();
      result_.surface_samples += result_.ray_samples;
      back.merge(rays);
    }
    summarise(forth, back);
    return result_;
  }

 private:
  /// Runs `body(i, tally)` for all batches in parallel.
  template <class Body>
  Tally batches(std::size_t count, const char* stage, Body body) {
    std::vector<Tally> tallies(count);
    std::atomic<std::size_t> done{0};
    std::atomic<bool> stopped{false};
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (stopped.load(std::memory_order_relaxed)) return;
      body(i, tallies[i]);
      const std::size_t finished = ++done;
      if (!options_.progress || finished % 16 != 0) return;
      options_.progress->report(stage, static_cast<double>(finished) / static_cast<double>(count));
      if (options_.progress->cancelled()) stopped = true;
    });
    if (stopped) result_.complete = false;
    Tally total;
    for (const Tally& tally : tallies) total.merge(tally);
    return total;
  }

  // ---- Mesh to surface ----

  Tally mesh_to_surface() {
    const std::span<const std::uint32_t> order = tree_.spatial_order();
    first_use_.assign(mesh_.positions.size(), ClosestPoint::kNone);
    area_before_.assign(order.size() + 1, 0.0);
    std::size_t fixed = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      area_before_[i + 1] = area_before_[i] + norm(area_vector(mesh_, order[i]));
      const auto& triangle = mesh_.triangles[order[i]];
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& use = first_use_[triangle[k]];
        if (options_.at_vertices && use == ClosestPoint::kNone) ++fixed;
        if (use == ClosestPoint::kNone) use = static_cast<std::uint32_t>(i);
        if (triangle[k] < triangle[(k + 1) % 3]) ++fixed;
      }
      ++fixed;
    }
    const double area = area_before_.back();
    random_count_ =
        area > 0 && area < kInfinity && options_.samples > fixed ? options_.samples - fixed : 0;
    const std::size_t regular = (order.size() + kTrianglesPerBatch - 1) / kTrianglesPerBatch;
    const std::size_t random = (random_count_ + kSamplesPerBatch - 1) / kSamplesPerBatch;
    return batches(regular + random, "measure", [&](std::size_t batch, Tally& tally) {
      Samples samples;
      if (batch < regular) {
        add_regular(batch * kTrianglesPerBatch, samples);
      } else {
        add_random((batch - regular) * kSamplesPerBatch, samples);
      }
      measure_samples(samples, tally);
    });
  }

  void add_regular(std::size_t begin, Samples& samples) const {
    const std::span<const std::uint32_t> order = tree_.spatial_order();
    const std::size_t end = std::min(begin + kTrianglesPerBatch, order.size());
    for (std::size_t i = begin; i < end; ++i) {
      const auto& triangle = mesh_.triangles[order[i]];
      Vec3d sum;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& p = mesh_.positions[triangle[k]];
        sum += p;
        if (options_.at_vertices && first_use_[triangle[k]] == i &&
            std::find(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(k),
                      triangle[k]) == triangle.begin() + static_cast<std::ptrdiff_t>(k)) {
          samples.add(p);
        }
        // Each edge of a closed mesh is met once in either direction; one of them counts.
        const auto next = triangle[(k + 1) % 3];
        if (triangle[k] < next) samples.add(0.5 * (p + mesh_.positions[next]));
      }
      samples.add(sum / 3.0, area_vector(mesh_, order[i]));
    }
  }

  /// Samples begin, begin + 1, ... of random_count_: sample k lies at a random place of the k-th of
  /// as many equal shares of the area.
  void add_random(std::size_t begin, Samples& samples) const {
    const std::size_t end = std::min(begin + kSamplesPerBatch, random_count_);
    const double share = area_before_.back() / static_cast<double>(random_count_);
    for (std::size_t k = begin; k < end; ++k) {
      Random random(options_.seed, k);
      const double place = (static_cast<double>(k) + random.uniform()) * share;
      const auto above = std::upper_bound(area_before_.begin(), area_before_.end() - 1, place);
      const auto i = static_cast<std::size_t>(above - area_before_.begin()) - 1;
      const std::uint32_t t = tree_.spatial_order()[std::min(i, mesh_.triangles.size() - 1)];
      const auto& [a, b, c] = mesh_.triangles[t];
      // The square root makes the density even over the triangle.
      const double u = std::sqrt(random.uniform()), v = random.uniform();
      samples.add((1 - u) * mesh_.positions[a] + u * (1 - v) * mesh_.positions[b] +
                      u * v * mesh_.positions[c],
                  area_vector(mesh_, t));
    }
  }

  void measure_samples(const Samples& samples, Tally& tally) const {
    std::vector<Projection> nearest(samples.points.size());
    if (surfaces_.size() == 1) {
      project(*surfaces_[0], samples.points, search_limit_, nearest);
    } else {
      project_to_nearest(samples.points, nearest);
    }
    confirm_farthest(samples.points, nearest);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      tally.add(nearest[i].distance, samples.points[i]);
      const Vec3d& normal = samples.normals[i];
      const Vec3d& gradient = nearest[i].gradient;
      if (!(squared_norm(normal) > 0 && squared_norm(gradient) > 0)) continue;
      const double angle = degrees_between(normal, -gradient);
      tally.angle.take(angle, samples.points[i]);
      tally.angle_sum += angle;
      ++tally.angles;
    }
  }

  /// Where F has walls, the gradient leads past the nearest surface: searches around the farthest
  /// sample of a batch until that stays the farthest.
  void confirm_farthest(const std::vector<Vec3d>& points, std::vector<Projection>& nearest) const {
    const auto less = [](const Projection& a, const Projection& b) {
      return a.distance < b.distance;
    };
    for (std::size_t round = 0; round < nearest.size(); ++round) {
      const auto farthest = std::max_element(nearest.begin(), nearest.end(), less);
      if (farthest == nearest.end() || !std::isfinite(farthest->distance)) return;
      const Vec3d& p = points[static_cast<std::size_t>(farthest - nearest.begin())];
      double found = farthest->distance;
      for (const ImplicitSurface* surface : surfaces_) {
        const std::optional<SignChange> nearer = search_around(*surface, p, found, true);
        if (nearer) found = std::min(found, nearer->distance);
      }
      if (!(found < 0.99 * farthest->distance)) return;
      farthest->distance = found;
    }
  }

  /// Tries the surface that seems nearest to each point first, and others only where they could be
  /// nearer still.
  void project_to_nearest(const std::vector<Vec3d>& points, std::vector<Projection>& best) const {
    std::vector<std::vector<double>> guess(surfaces_.size());
    std::vector<Jet> jets(points.size());
    std::vector<std::size_t> first(points.size(), 0);
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      surfaces_[s]->jets(points, jets);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double slope = norm(jets[i].gradient);
        guess[s].push_back(slope > 0 ? std::abs(jets[i].value) / slope : search_limit_);
        if (guess[s][i] < guess[first[i]][i]) first[i] = s;
      }
    }
    const auto try_where = [&](std::size_t s, auto condition) {
      std::vector<std::size_t> chosen;
      std::vector<Vec3d> some;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!condition(i)) continue;
        chosen.push_back(i);
        some.push_back(points[i]);
      }
      if (some.empty()) return;
      std::vector<Projection> found(some.size());
      project(*surfaces_[s], some, search_limit_, found);
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        if (found[k].distance < best[chosen[k]].distance) best[chosen[k]] = found[k];
      }
    };
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      try_where(s, [&](std::size_t i) { return first[i] == s; });
    }
    // The guess is the length of a Newton step: allow for F being curved.
    constexpr double kDoubt = 4;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      try_where(s, [&](std::size_t i) {
        return first[i] != s && guess[s][i] < kDoubt * best[i].distance;
      });
    }
  }

  // ---- Surface to mesh ----

  /// Where to look for surface: its bounds, or around the mesh if they are infinite.
  Aabb region_of(const ImplicitSurface& surface) const {
    const Aabb box = surface.bounds();
    if (box.empty()) return box;
    const Aabb around = bounds(mesh_);
    const Aabb limits = around.empty() ? Aabb{} : around.grown(around.diagonal());
    Aabb region{max(box.min, Vec3d{-1e300, -1e300, -1e300}),
                min(box.max, Vec3d{1e300, 1e300, 1e300})};
    if (!box.finite()) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(box.min[axis])) region.min[axis] = limits.min[axis];
        if (!std::isfinite(box.max[axis])) region.max[axis] = limits.max[axis];
      }
    }
    return region;
  }

  Tally surface_to_mesh() {
    Tally total;
    const std::size_t each = std::max<std::size_t>(options_.samples / surfaces_.size(), 1000);
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      const std::vector<SurfaceBlock> blocks = surface_blocks(
          *surfaces_[s], region_of(*surfaces_[s]), each, options_.seed, options_.progress);
      const int cells = cells_per_block(blocks.size(), each);
      total.merge(batches(blocks.size(), "measure", [&](std::size_t i, Tally& tally) {
        std::vector<Vec3d> points;
        append_crossings(blocks[i], cells, points);
        measure_back(s, points, tally);
      }));
    }
    return total;
  }

  /// Lines evenly distributed among all that meet the sphere around the bounds; their crossings are
  /// evenly distributed over the surface (Crofton).
  Tally certified_rays() {
    Tally total;
    const std::size_t each = options_.certified_rays / surfaces_.size();
    for (std::size_t s = 0; each > 0 && s < surfaces_.size(); ++s) {
      const Aabb region = region_of(*surfaces_[s]);
      if (region.empty() || !region.finite()) continue;
      const double radius = 0.5 * region.diagonal();
      const BoundTree tree(*surfaces_[s]);
      const std::size_t count = (each + kRaysPerBatch - 1) / kRaysPerBatch;
      total.merge(batches(count, "measure", [&](std::size_t batch, Tally& tally) {
        std::vector<Vec3d> points;
        std::vector<RayHit> hits;
        for (std::size_t k = batch * kRaysPerBatch; k < std::min((batch + 1) * kRaysPerBatch, each);
             ++k) {
          Random random(options_.seed + 0x72617973, k);
          const Vec3d direction = random.direction();
          const Vec3d side = cross(direction, random.direction());
          const double length = norm(side);
          if (!(length > 0)) continue;
          const Vec3d offset = side * (radius * std::sqrt(random.uniform()) / length);
          const Ray ray{region.center() + offset - radius * direction, normalized(direction)};
          all_hits(tree, ray, 0, 2 * radius, {}, hits);
          for (const RayHit& hit : hits) {
            if (hit.status == RayStatus::hit) points.push_back(ray.at(hit.t));
            if (hit.status == RayStatus::uncertain) ++tally.uncertain;
          }
        }
        measure_back(s, points, tally);
      }));
    }
    return total;
  }

  /// Whether solids touch face to face at a point of the one, so that it is inside their union.
  bool back_to_back(const Jet& own, const Jet& other) const {
    const double slopes = norm(own.gradient) * norm(other.gradient);
    return dot(own.gradient, other.gradient) < -0.999 * slopes &&
           first_order_distance(other, search_limit_) <= 1e-9 * search_limit_;
  }

  void measure_back(std::size_t surface, const std::vector<Vec3d>& points, Tally& tally) const {
    std::vector<bool> hidden(points.size(), false);
    std::vector<Jet> own(points.size()), jets(points.size());
    if (surfaces_.size() > 1) surfaces_[surface]->jets(points, own);
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      if (s == surface || points.empty()) continue;
      surfaces_[s]->jets(points, jets);
      for (std::size_t i = 0; i < points.size(); ++i) {
        hidden[i] = hidden[i] || jets[i].value > 0 || back_to_back(own[i], jets[i]);
      }
    }
    std::vector<Vec3d> seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!hidden[i]) seen.push_back(points[i]);
    }
    tree_.nearest_each(seen, [&](std::size_t i, const ClosestPoint::Hit& hit) {
      tally.add(hit.distance, seen[i]);
    });
  }

  // ---- Both ----

  void summarise(const Tally& forth, const Tally& back) {
    result_.mesh_to_surface_max = forth.distance.value;
    result_.mesh_to_surface_at = forth.distance.at;
    result_.surface_to_mesh_max = back.distance.value;
    result_.surface_to_mesh_at = back.distance.at;
    result_.normal_deg_max = forth.angle.value;
    result_.normal_deg_at = forth.angle.at;
    if (forth.angles > 0) {
      result_.normal_deg_mean = forth.angle_sum / static_cast<double>(forth.angles);
    }
    result_.mesh_samples = forth.distances.size();
    result_.uncertain_rays = back.uncertain;
    std::vector<float> all = forth.distances;
    all.insert(all.end(), back.distances.begin(), back.distances.end());
    if (all.empty()) return;
    result_.rms = std::sqrt((forth.squares + back.squares) / static_cast<double>(all.size()));
    const auto rank =
        static_cast<std::ptrdiff_t>(std::ceil(0.999 * static_cast<double>(all.size())) - 1);
    std::nth_element(all.begin(), all.begin() + rank, all.end());
    result_.p999 = static_cast<double>(all[static_cast<std::size_t>(rank)]);
  }

  std::span<const ImplicitSurface* const> surfaces_;
  const TriangleMesh& mesh_;
  const MeasureOptions& options_;
  ClosestPoint tree_;
  double search_limit_ = 0;
  std::vector<std::uint32_t> first_use_;  ///< place in spatial order that samples the vertex
  std::vector<double> area_before_;       ///< of the triangles before it in spatial order
  std::size_t random_count_ = 0;
  MeasuredError result_;
};

}  // namespace

MeasuredError measure(const ImplicitSurface& surface, const TriangleMesh& mesh,
                      const MeasureOptions& options) {
  const ImplicitSurface* const only = &surface;
  return measure({&only, 1}, mesh, options);
}

MeasuredError measure(std::span<const ImplicitSurface* const> surfaces, const TriangleMesh& mesh,
                      const MeasureOptions& options) {
  if (surfaces.empty()) {
    MeasuredError error;
    error.mesh_to_surface_max = mesh.empty() ? 0 : kInfinity;
    return error;
  }
  return Measurement(surfaces, mesh, options).run();
}

}  // namespace cs2mesh
