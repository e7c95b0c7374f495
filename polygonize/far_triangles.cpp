#include "polygonize/far_triangles.h"

#include <optional>

#include "polygonize/surface_projection.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of the tolerance: up to here the first order is believed, and from here on a foot is searched.
constexpr double kSurely = 0.25, kNearly = 0.8;

/// The distances of points, by their jets: to the first order, but where that leaves doubts F is
/// asked a tolerance away along the gradient. A change of sign proves that there is surface on the
/// way; none, as over a thorn or a saddle where F gets flatter, that there may not be.
std::vector<double> distances_of(const ImplicitSurface& surface, std::span<const Vec3d> points,
                                 std::span<const Jet> jets, double tolerance) {
  std::vector<double> distances(points.size());
  std::vector<std::size_t> doubtful;
  std::vector<Vec3d> ends;
  Aabb box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    distances[i] = first_order_distance(jets[i], kInfinity);
    const double slope = norm_of_any(jets[i].gradient);
    if (!(distances[i] > kSurely * tolerance) || !(slope > 0 && slope < kInfinity)) continue;
    const double way = jets[i].value >= 0 ? -tolerance : tolerance;
    ends.push_back(points[i] + way / slope * jets[i].gradient);
    doubtful.push_back(i);
    box.include(ends.back());
  }
  if (ends.empty()) return distances;
  std::vector<double> values(ends.size());
  surface.restrict_to(box)->values(ends, values);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    double& distance = distances[doubtful[k]];
    const bool crossed = (values[k] >= 0) != (jets[doubtful[k]].value >= 0);
    distance = crossed ? std::min(distance, kNearly * tolerance) : std::max(distance, tolerance);
  }
  return distances;
}

/// Where a triangle is too far from the surface, if it is at this point. Where F has walls its
/// gradient may point past the nearest surface.
std::optional<LostPoint> far_point(const ImplicitSurface& surface, std::size_t triangle,
                                   const Vec3d& p, double distance, const FarOptions& options) {
  if (!(distance > kNearly * options.tolerance)) return std::nullopt;
  const Foot foot =
      find_foot(surface, p, std::min(distance, options.longest_way), options.tolerance);
  if (!(foot.distance > options.tolerance)) return std::nullopt;
  return LostPoint{foot.point, p, foot.distance, static_cast<std::uint32_t>(triangle)};
}

}  // namespace

std::vector<Jet> jets_at_neighbours(const ImplicitSurface& surface, std::span<const Vec3d> points) {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  std::vector<Jet> jets(points.size());
  if (!points.empty()) surface.restrict_to(box)->jets(points, jets);
  return jets;
}

std::vector<LostPoint> far_triangles(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                     std::span<const std::size_t> triangles,
                                     const FarOptions& options) {
  constexpr double kDoubt = 0.5;     // of the tolerance
  constexpr std::size_t kFirst = 4;  // points of a triangle
  std::vector<Vec3d> points;
  for (const std::size_t t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    points.push_back(sample_point(mesh, t));
    points.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    points.push_back(0.5 * (mesh.positions[b] + mesh.positions[c]));
    points.push_back(0.5 * (mesh.positions[c] + mesh.positions[a]));
  }
  const std::vector<Jet> jets = jets_at_neighbours(surface, points);
  const std::vector<double> distances = distances_of(surface, points, jets, options.tolerance);
  std::vector<std::optional<LostPoint>> found(triangles.size());
  std::vector<Vec3d> closer;
  std::vector<std::size_t> doubtful;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    double most = 0.0;
    for (std::size_t k = kFirst * i; k < kFirst * (i + 1) && !found[i]; ++k) {
      found[i] = far_point(surface, triangles[i], points[k], distances[k], options);
      most = std::max(most, distances[k]);
    }
    if (found[i]) continue;
    const auto more = more_points(mesh, triangles[i],
                                  look_of(mesh, triangles[i], jets[kFirst * i], most,
                                          kDoubt * options.tolerance, options.small));
    closer.insert(closer.end(), more.begin(), more.end());
    doubtful.insert(doubtful.end(), more.size(), i);
  }
  const std::vector<double> closer_distances =
      distances_of(surface, closer, jets_at_neighbours(surface, closer), options.tolerance);
  for (std::size_t k = 0; k < closer.size(); ++k) {
    std::optional<LostPoint>& verdict = found[doubtful[k]];
    if (verdict) continue;
    verdict = far_point(surface, triangles[doubtful[k]], closer[k], closer_distances[k], options);
  }
  std::vector<LostPoint> far;
  for (const auto& verdict : found) {
    if (verdict) far.push_back(*verdict);
  }
  return far;
}

}  // namespace cs2mesh
