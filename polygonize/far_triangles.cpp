#include "polygonize/far_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "polygonize/distinct_points.h"
#include "polygonize/near_proof.h"
#include "polygonize/surface_projection.h"
#include "polygonize/told_heights.h"
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
  std::vector<Vec3d> ends;
  std::vector<std::size_t> doubtful;
  for (std::size_t i = 0; i < points.size(); ++i) {
    distances[i] = first_order_distance(jets[i], kInfinity);
    const double slope = norm_of_any(jets[i].gradient);
    if (!(distances[i] > kSurely * tolerance) || !(slope > 0 && slope < kInfinity)) continue;
    const double way = (jets[i].value >= 0 ? -tolerance : tolerance) / slope;
    if (!std::isfinite(way)) continue;
    ends.push_back(points[i] + way * jets[i].gradient);
    doubtful.push_back(i);
  }
  if (ends.empty()) return distances;
  const DistinctPoints distinct(ends);
  Aabb box;
  for (const Vec3d& p : distinct.points()) box.include(p);
  std::vector<double> values(distinct.points().size());
  surface.restrict_to(box)->values(distinct.points(), values);
  for (std::size_t k = 0; k < ends.size(); ++k) {
    double& distance = distances[doubtful[k]];
    const bool crossed = (values[distinct.number(k)] >= 0) != (jets[doubtful[k]].value >= 0);
    distance = crossed ? std::min(distance, kNearly * tolerance) : std::max(distance, tolerance);
  }
  return distances;
}

/// The jets at points, of which many are given twice.
std::vector<Jet> jets_of(const ImplicitSurface& surface, std::span<const Vec3d> points) {
  const DistinctPoints distinct(points);
  const std::vector<Jet> jets = jets_at_neighbours(surface, distinct.points());
  std::vector<Jet> all;
  all.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) all.push_back(jets[distinct.number(i)]);
  return all;
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

/// Looks at points of some triangles: none where it is known to be near by its corners, few where
/// the surface is as its normals at the corners tell, else many.
class Measurer {
 public:
  Measurer(const ImplicitSurface& surface, const TriangleMesh& mesh,
           std::span<const std::size_t> triangles, const FarOptions& options)
      : surface_(surface),
        mesh_(mesh),
        triangles_(triangles),
        options_(options),
        records_(triangles.size()) {}

  std::vector<LostPoint> run() {
    look_at_corners();
    for (std::size_t i = 0; i < records_.size(); ++i) want_first(i);
    look();
    leave_what_is_as_told();
    judge();
    want_more();
    look();
    judge();
    std::vector<LostPoint> far;
    for (const Record& record : records_) {
      if (record.lost) far.push_back(*record.lost);
    }
    return far;
  }

 private:
  struct Known {
    Vec3d point;
    double distance = 0.0;
  };
  /// What is known of a triangle.
  struct Record {
    std::array<Jet, 3> corner;
    std::vector<Known> known;
    std::optional<Jet> first;  ///< at the first point that was looked at
    double most = 0.0;         ///< distance
    bool done = false;         ///< near, or lost
    std::optional<LostPoint> lost;
  };
  /// A point of a triangle that is looked at.
  struct Sample {
    std::size_t of = 0;
    Vec3d point;
    Jet jet;
  };

  TriangleCorners corners_of(std::size_t i) const {
    const auto& [a, b, c] = mesh_.triangles[triangles_[i]];
    return {mesh_.positions[a], mesh_.positions[b], mesh_.positions[c]};
  }

  void look_at_corners() {
    std::vector<Vec3d> corners;
    for (const std::size_t t : triangles_) {
      for (const auto v : mesh_.triangles[t]) corners.push_back(mesh_.positions[v]);
    }
    const std::vector<Jet> jets = jets_of(surface_, corners);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      Record& record = records_[k / 3];
      record.corner[k % 3] = jets[k];
      record.known.push_back({corners[k], first_order_distance(jets[k], kInfinity)});
    }
  }

  /// Whether the point was looked at, or is near by what is known: distances differ by no more than
  /// the way between two points. Beyond a crease they may be twice what the first order says.
  bool is_covered(const Record& record, const Vec3d& p) const {
    return std::any_of(record.known.begin(), record.known.end(),
                       [&](const Known& known) { return covers(known, p); });
  }
  bool covers(const Known& known, const Vec3d& p) const {
    const bool sure = known.distance <= kSurely * options_.tolerance;
    const double reach = sure ? options_.tolerance - 2 * known.distance : 0.0;
    return squared_norm(p - known.point) <= reach * reach;
  }

  void want(std::size_t i, const Vec3d& p) {
    if (!is_covered(records_[i], p)) samples_.push_back({i, p, {}});
  }

  void want_first(std::size_t i) {
    const Vec3d sample = sample_point(mesh_, triangles_[i]);
    // What is that near to all three corners has the rest near one of them.
    const std::vector<Known>& corners = records_[i].known;
    if (std::all_of(corners.begin(), corners.end(),
                    [&](const Known& corner) { return covers(corner, sample); })) {
      return;
    }
    samples_.push_back({i, sample, {}});
    const auto& [a, b, c] = mesh_.triangles[triangles_[i]];
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      const Vec3d middle = 0.5 * (mesh_.positions[p] + mesh_.positions[q]);
      if (squared_norm(middle - sample) > 0) want(i, middle);
    }
  }

  /// Whether the surface turns so much between the corners that there may be a kink.
  bool is_folded(const Record& record) const {
    constexpr double kTurned = 0.8;  // cosine
    if (!(options_.small > 0)) return false;
    const auto& [a, b, c] = record.corner;
    const auto turned = [](const Jet& from, const Jet& to) {
      return !(dot(from.gradient, to.gradient) >
               kTurned * norm_of_any(from.gradient) * norm_of_any(to.gradient));
    };
    return turned(a, b) || turned(b, c) || turned(c, a);
  }

  void want_more() {
    constexpr double kDoubt = 0.5, kLarge = 0.7;  // of the tolerance
    for (std::size_t i = 0; i < records_.size(); ++i) {
      const Record& record = records_[i];
      if (record.done || !record.first) continue;
      Look closely = look_of(mesh_, triangles_[i], *record.first, record.most,
                             kDoubt * options_.tolerance, options_.small);
      // The surface is not as told and nearly too far: as beside a kink, it may be farther
      // anywhere.
      if (record.most > kLarge * options_.tolerance || is_folded(record)) closely = Look::all_over;
      for (const Vec3d& p : more_points(mesh_, triangles_[i], closely)) want(i, p);
    }
  }

  void look() {
    std::vector<Vec3d> points;
    points.reserve(samples_.size());
    for (const Sample& sample : samples_) points.push_back(sample.point);
    const std::vector<Jet> jets = jets_of(surface_, points);
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      samples_[k].jet = jets[k];
      Record& record = records_[samples_[k].of];
      if (!record.first) record.first = jets[k];
    }
  }

  /// Leaves triangles above which the surface is where the normals at the corners tell.
  void leave_what_is_as_told() {
    std::vector<double> off(records_.size(), 0.0);
    std::vector<ToldHeights> told;
    told.reserve(records_.size());
    for (std::size_t i = 0; i < records_.size(); ++i) {
      told.push_back(ToldHeights(corners_of(i), records_[i].corner));
    }
    for (const Sample& sample : samples_) {
      off[sample.of] = std::max(off[sample.of], told[sample.of].off_by(sample.point, sample.jet));
    }
    for (std::size_t i = 0; i < records_.size(); ++i) {
      records_[i].done = records_[i].first && told[i].are_within(options_.tolerance, off[i]);
    }
    std::erase_if(samples_, [&](const Sample& sample) { return records_[sample.of].done; });
  }

  /// Judges the points that were looked at.
  void judge() {
    std::vector<Vec3d> points;
    std::vector<Jet> jets;
    for (const Sample& sample : samples_) {
      points.push_back(sample.point);
      jets.push_back(sample.jet);
    }
    const std::vector<double> distances = distances_of(surface_, points, jets, options_.tolerance);
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      Record& record = records_[samples_[k].of];
      record.most = std::max(record.most, distances[k]);
      record.known.push_back({points[k], distances[k]});
      if (record.lost) continue;
      record.lost =
          far_point(surface_, triangles_[samples_[k].of], points[k], distances[k], options_);
      record.done = record.lost.has_value();
    }
    samples_.clear();
  }

  const ImplicitSurface& surface_;
  const TriangleMesh& mesh_;
  std::span<const std::size_t> triangles_;
  const FarOptions& options_;
  std::vector<Record> records_;
  std::vector<Sample> samples_;
};

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
  if (options.directions.empty()) return Measurer(surface, mesh, triangles, options).run();
  const std::vector<bool> proven =
      proven_near(surface, mesh, triangles, options.directions, options.tolerance);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!proven[i]) open.push_back(triangles[i]);
  }
  return Measurer(surface, mesh, open, options).run();
}

}  // namespace cs2mesh
