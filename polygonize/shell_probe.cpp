#include "polygonize/shell_probe.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// Triangles whose points are evaluated together.
constexpr std::size_t kChunk = 32;

bool inside(double f) {
  return f >= 0;
}

/// A point of the mesh from which one looks along `way`, a unit vector.
struct Probe {
  Vec3d from, way;
  bool below = false;
};

/// Points on a grid over a triangle, each looked at from both sides.
void append_probes(const TriangleMesh& mesh, std::size_t triangle, double spacing, bool smooth,
                   std::vector<Probe>& probes) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3d area = area_vector(mesh, triangle);
  const double twice = norm(area);
  if (!(twice > 0)) return;
  const Vec3d up = area / twice;
  // A point for each square of the spacing.
  constexpr double kSmoothRows = 2, kMostRows = 8;
  const double wanted = smooth ? kSmoothRows : std::ceil(std::sqrt(twice) / spacing);
  const int rows = static_cast<int>(std::clamp(wanted, 1.0, kMostRows));
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; i + j < rows; ++j) {
      const double u = (i + 1.0 / 3) / rows, v = (j + 1.0 / 3) / rows;
      const Vec3d p = a + u * (b - a) + v * (c - a);
      probes.push_back({p, up, false});
      probes.push_back({p, -up, true});
    }
  }
}

class Prober {
 public:
  Prober(const ImplicitSurface& surface, const TriangleMesh& mesh, const ClosestPoint& tree,
         const ShellProbeOptions& options)
      : surface_(surface), mesh_(mesh), tree_(tree), options_(options) {}

  std::vector<LostPoint> look(std::size_t first, std::size_t last) const {
    std::vector<std::size_t> fresh;
    Aabb around;
    for (std::size_t t = first; t < last; ++t) {
      const auto& corners = mesh_.triangles[t];
      if (*std::max_element(corners.begin(), corners.end()) < options_.first_new) continue;
      fresh.push_back(t);
      for (const auto v : corners) around.include(mesh_.positions[v]);
    }
    if (fresh.empty()) return {};
    around = around.grown(2 * options_.enough);
    const bool smooth = std::isfinite(surface_.derivative_bound(2, around));
    std::vector<Probe> probes;
    for (const std::size_t t : fresh) {
      append_probes(mesh_, t, options_.spacing * options_.enough, smooth, probes);
    }
    std::vector<Vec3d> points;
    Aabb box;
    for (const Probe& probe : probes) {
      points.push_back(at(probe, options_.enough));
      box.include(points.back());
    }
    std::vector<double> values(points.size());
    if (!points.empty()) surface_.restrict_to(box)->values(points, values);
    std::vector<LostPoint> lost;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      if (inside(values[i]) == probes[i].below) continue;
      const std::optional<LostPoint> found = follow(probes[i]);
      if (found) lost.push_back(*found);
    }
    return lost;
  }

 private:
  static Vec3d at(const Probe& probe, double distance) { return probe.from + distance * probe.way; }

  /// Goes on until the sign is right, as long as that is away from the mesh.
  std::optional<LostPoint> follow(const Probe& probe) const {
    constexpr int kMostSteps = 32, kHalvings = 20;
    const double step = 0.25 * options_.enough;
    double wrong = options_.enough;
    if (tree_.nearest(at(probe, wrong)).distance < 0.9 * options_.enough) return std::nullopt;
    double right = wrong;
    for (int i = 0; i < kMostSteps && right == wrong; ++i) {
      const double next = wrong + step;
      const bool changed = inside(surface_.value(at(probe, next))) == probe.below;
      (changed ? right : wrong) = next;
      if (!changed) right = wrong;
    }
    if (right == wrong) return std::nullopt;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (wrong + right);
      (inside(surface_.value(at(probe, middle))) == probe.below ? right : wrong) = middle;
    }
    const Vec3d end = at(probe, right);
    const ClosestPoint::Hit hit = tree_.nearest(end);
    if (!(hit.distance > options_.enough)) return std::nullopt;
    return LostPoint{end, hit.point, hit.distance, hit.triangle};
  }

  const ImplicitSurface& surface_;
  const TriangleMesh& mesh_;
  const ClosestPoint& tree_;
  const ShellProbeOptions& options_;
};

}  // namespace

std::vector<LostPoint> probe_shell(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                   const ClosestPoint& tree, const ShellProbeOptions& options) {
  require(options.enough > 0 && options.spacing > 0, "probe_shell: distances must be positive");
  const Prober prober(surface, mesh, tree, options);
  const std::size_t count = mesh.triangles.size();
  std::vector<std::vector<LostPoint>> chunks((count + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
    if (cancelled(options.progress)) return;
    chunks[i] = prober.look(kChunk * i, std::min(kChunk * (i + 1), count));
  });
  std::vector<LostPoint> lost;
  for (const auto& chunk : chunks) lost.insert(lost.end(), chunk.begin(), chunk.end());
  return lost;
}

}  // namespace cs2mesh
