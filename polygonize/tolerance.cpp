#include "polygonize/tolerance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/both_ways.h"
#include "polygonize/surface_projection.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

/// Triangles measured together through one restriction of F: neighbours in the mesh's order.
constexpr std::size_t kChunk = 128;
/// Chunks whose samples are kept at once.
constexpr std::size_t kWave = 256;

struct Sample {
  double distance = 0.0;  ///< to the first order
  Vec3d point;
  Vec3d way;  ///< towards the surface, as the gradient tells; a unit vector, or 0
};

Vec3d way_of(const Jet& jet) {
  const double slope = norm_of_any(jet.gradient);
  return slope > 0 ? (jet.value >= 0 ? -1.0 : 1.0) * (jet.gradient / slope) : Vec3d{};
}

/// Appends samples at points of the mesh that are near each other, with first-order distances no
/// larger than the box around them, and gives their jets.
std::vector<Jet> append_samples(const ImplicitSurface& surface, std::span<const Vec3d> points,
                                std::vector<Sample>& samples) {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  std::vector<Jet> jets(points.size());
  if (!points.empty()) surface.restrict_to(box)->jets(points, jets);
  for (std::size_t i = 0; i < points.size(); ++i) {
    samples.push_back({first_order_distance(jets[i], box.diagonal()), points[i], way_of(jets[i])});
  }
  return jets;
}

/// One sample of each triangle in [first, last), and more of those that ask for it; those no
/// farther than `near` are left out.
std::vector<Sample> sample_triangles(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                     std::size_t first, std::size_t last, double closer,
                                     double small, double near) {
  std::vector<Vec3d> points;
  for (std::size_t t = first; t < last; ++t) points.push_back(sample_point(mesh, t));
  std::vector<Sample> samples;
  const std::vector<Jet> jets = append_samples(surface, points, samples);
  points.clear();
  for (std::size_t t = first; t < last; ++t) {
    const std::size_t i = t - first;
    const Look look = look_of(mesh, t, jets[i], samples[i].distance, closer, small);
    const std::vector<Vec3d> more = more_points(mesh, t, look);
    points.insert(points.end(), more.begin(), more.end());
  }
  append_samples(surface, points, samples);
  std::erase_if(samples, [near](const Sample& sample) { return sample.distance <= near; });
  return samples;
}

/// Whether there is surface within that distance of a sample, at least where the gradient points.
bool is_near(const ImplicitSurface& surface, const Sample& sample, double distance) {
  const Vec3d ends[] = {sample.point, sample.point + distance * sample.way};
  double values[2];
  surface.values(ends, values);
  return (values[0] >= 0) != (values[1] >= 0);
}

/// An upper bound of the distance of the surface from a sample, the first that is no more than
/// `enough`. Between near sheets the way along the gradient may pass the nearer one, and beside
/// kinks the surface is nearest where no gradient points.
double distance_from(const ImplicitSurface& surface, const Sample& sample, double enough) {
  if (enough > 0 && is_near(surface, sample, enough)) return enough;
  const double distance = find_foot(surface, sample.point, sample.distance, enough).distance;
  if (distance <= enough) return distance;
  const std::optional<SignChange> nearer =
      search_around(surface, sample.point, distance, /*closely=*/true);
  return nearer ? std::min(distance, nearer->distance) : distance;
}

/// The largest distance of these samples, if that is more than `largest`. The first order errs far
/// from the surface, near creases and between walls: looks closely at the farthest, until none of
/// the others can be farther than what was found.
double farthest_of(const ImplicitSurface& surface, std::vector<Sample> samples, double largest,
                   Progress* progress) {
  constexpr std::size_t kBatch = 256;
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.distance > b.distance; });
  std::vector<double> distances(kBatch);
  for (std::size_t first = 0;
       first < samples.size() && samples[first].distance > largest && !cancelled(progress);
       first += kBatch) {
    const std::size_t count = std::min(kBatch, samples.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      distances[i] = distance_from(surface, samples[first + i], largest);
    });
    const auto end = distances.begin() + static_cast<std::ptrdiff_t>(count);
    largest = std::max(largest, *std::max_element(distances.begin(), end));
  }
  return largest;
}

/// A mesh is refined to the first of these shares of the tolerance, and taken when its estimate is
/// within the second: both look at some points only.
constexpr double kAim = 0.85, kAccept = 0.96;

/// From this share of the tolerance on, a place is looked at more closely; up to this one it does
/// not matter how near it is.
constexpr double kCloser = 0.4, kSurely = 0.8;

}  // namespace

Diagnostic tolerance_missed(double tolerance, double error, double cell) {
  std::ostringstream text;
  text << "the tolerance " << tolerance << " was not reached: ";
  if (std::isfinite(error)) {
    text << "the mesh is within " << error << " of the surface (cell " << cell << ")";
  } else {
    text << "on cells of " << cell << " triangles cross or stay far from the surface";
  }
  return {Severity::warning, Failure::tolerance, {}, text.str()};
}

double GradientEstimate::largest_distance(const ImplicitSurface& surface,
                                          const TriangleMesh& mesh) const {
  const std::size_t count = mesh.triangles.size();
  double largest = enough_;
  for (std::size_t wave = 0; wave < count && !cancelled(progress_); wave += kWave * kChunk) {
    const std::size_t end = std::min(wave + kWave * kChunk, count);
    std::vector<std::vector<Sample>> chunks((end - wave + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      const std::size_t first = wave + kChunk * i;
      chunks[i] = sample_triangles(surface, mesh, first, std::min(first + kChunk, end), closer_,
                                   small_, largest);
    });
    std::vector<Sample> samples;
    for (const auto& chunk : chunks) samples.insert(samples.end(), chunk.begin(), chunk.end());
    largest = farthest_of(surface, std::move(samples), largest, progress_);
  }
  return largest;
}

double expected_cell(double radius, bool creased, double tolerance) {
  constexpr double kSagitta = 0.3;
  constexpr double kShare = 0.8;      // of the tolerance
  constexpr double kFollow = 0.7;     // of the radius: at least three cells across
  constexpr double kCreaseCells = 3;  // tolerances in a cell
  double cell = std::min(std::sqrt(kShare * tolerance * radius / kSagitta), kFollow * radius);
  if (creased) cell = std::min(cell, kCreaseCells * tolerance);
  return cell;
}

namespace {

/// Whether F has walls: places at the surface where it is far steeper than elsewhere.
bool has_walls(const ImplicitSurface& surface, std::span<const Vec3d> on_surface) {
  constexpr double kSteep = 4.0, kShare = 0.02;
  if (on_surface.empty()) return false;
  std::vector<Jet> jets(on_surface.size());
  surface.jets(on_surface, jets);
  std::vector<double> slopes;
  slopes.reserve(jets.size());
  for (const Jet& jet : jets) slopes.push_back(norm(jet.gradient));
  const auto at_share = [&](double share) {
    const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(slopes.size() - 1));
    std::nth_element(slopes.begin(), slopes.begin() + place, slopes.end());
    return slopes[static_cast<std::size_t>(place)];
  };
  return at_share(1 - kShare) > kSteep * at_share(0.5);
}

/// The first cell: larger than expected_cell(), as refine() makes up for that where it matters. Not
/// so between walls, where a large cell makes bridges.
double first_cell(double radius, bool creased, bool walls, double tolerance) {
  constexpr double kLarger = 1.25, kBetweenWalls = 1.7;
  const double shape_cell = expected_cell(radius, false, HUGE_VAL);
  const double cell = std::min(kLarger * expected_cell(radius, creased, tolerance), shape_cell);
  return walls ? std::min(cell, kBetweenWalls * tolerance) : cell;
}

class ToTolerance {
 public:
  ToTolerance(const ImplicitSurface& surface, double tolerance, const ToleranceOptions& options)
      : surface_(surface),
        tolerance_(tolerance),
        options_(options),
        gradient_(kCloser * kAim * tolerance, tolerance, kSurely * tolerance, options.progress),
        estimate_(options.estimate != nullptr ? *options.estimate : gradient_) {}

  Result<ToleranceMesh> run(double thinnest_radius, bool creased) {
    constexpr double kSmaller = 0.75;
    const bool walls = creased && has_walls(surface_, both_ways().on_surface());
    const bool cut_off = creased && !options_.follows_creases;
    double cell = first_cell(thinnest_radius, cut_off, walls, tolerance_);
    for (int attempt = 0; attempt < options_.most_attempts; ++attempt, cell *= kSmaller) {
      if (attempt < options_.left_out) continue;
      LatticeStatistics statistics;
      Result<TriangleMesh> mesh = options_.mesh_cells(
          surface_,
          {cell, options_.origin, options_.max_nodes, options_.max_triangles, options_.progress},
          &statistics);
      if (!mesh) {
        const Failure why = mesh.diagnostics().front().failure;
        if (why == Failure::check_failed && attempt + 1 < options_.most_attempts) continue;
        if (best_.attempts.empty() || why == Failure::interrupted) {
          return Result<ToleranceMesh>::failure(mesh.diagnostics());
        }
        remarks_ = mesh.diagnostics();
        for (Diagnostic& remark : remarks_) remark.severity = Severity::warning;
        break;
      }
      const double error = bring_near(*mesh, cell, statistics);
      if (cancelled(options_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      keep_better(*std::move(mesh), {cell, error, 0}, statistics);
      if (error <= kAccept * tolerance_) break;
    }
    best_.reached = best_.error <= tolerance_;
    if (!best_.reached) remarks_.push_back(tolerance_missed(tolerance_, best_.error, best_.cell));
    return {std::move(best_), std::move(remarks_)};
  }

 private:
  BothWays& both_ways() {
    if (!both_ways_) {
      both_ways_.emplace(surface_,
                         BothWaysOptions{kAim * tolerance_, tolerance_, options_.surface_samples,
                                         options_.max_triangles, options_.progress});
    }
    return *both_ways_;
  }

  /// Refines the mesh, and makes it coarse if that goes; returns its error.
  double bring_near(TriangleMesh& mesh, double cell, const LatticeStatistics& statistics) {
    const double back = both_ways().run(mesh);
    if (cancelled(options_.progress)) return HUGE_VAL;
    if (options_.coarsener != nullptr && back <= kAccept * tolerance_) {
      Coarsener::Coarse coarse = options_.coarsener->coarsen(mesh, cell);
      if (cancelled(options_.progress)) return HUGE_VAL;
      if (coarse.error <= kAccept * tolerance_) {
        mesh = std::move(coarse.mesh);
        return coarse.error;
      }
    }
    if (options_.progress != nullptr) options_.progress->report("measure", 0.0);
    return std::max({back, statistics.off_surface, estimate_.largest_distance(surface_, mesh)});
  }

  void keep_better(TriangleMesh mesh, ToleranceAttempt attempt,
                   const LatticeStatistics& statistics) {
    attempt.triangles = mesh.triangles.size();
    const bool better = best_.attempts.empty() || attempt.error < best_.error;
    best_.attempts.push_back(attempt);
    if (!better) return;
    best_.mesh = std::move(mesh);
    best_.cell = attempt.cell;
    best_.error = attempt.error;
    best_.statistics = statistics;
  }

  const ImplicitSurface& surface_;
  const double tolerance_;
  const ToleranceOptions& options_;
  const GradientEstimate gradient_;
  const DistanceEstimate& estimate_;
  std::optional<BothWays> both_ways_;  ///< once needed
  ToleranceMesh best_;
  std::vector<Diagnostic> remarks_;
};

}  // namespace

Result<ToleranceMesh> mesh_to_tolerance(const ImplicitSurface& surface, double thinnest_radius,
                                        bool creased, double tolerance,
                                        const ToleranceOptions& options) {
  require(thinnest_radius > 0 && std::isfinite(thinnest_radius),
          "mesh_to_tolerance: the radius must be positive");
  require(tolerance > 0 && std::isfinite(tolerance),
          "mesh_to_tolerance: the tolerance must be positive");
  require(0 <= options.left_out && options.left_out < options.most_attempts,
          "mesh_to_tolerance: at least one attempt");
  return ToTolerance(surface, tolerance, options).run(thinnest_radius, creased);
}

Result<MesherResult> mesh_on_cells(const ImplicitSurface& surface, const MesherRequest& request,
                                   ToleranceOptions options) {
  options.max_nodes = request.max_nodes;
  options.max_triangles = request.max_triangles;
  options.progress = request.progress;
  Result<ToleranceMesh> made = mesh_to_tolerance(surface, request.thinnest_radius, request.creased,
                                                 request.tolerance, options);
  if (!made) return Result<MesherResult>::failure(made.diagnostics());
  MesherResult result;
  result.error = made->error;
  result.cell = made->cell;
  result.reached = made->reached;
  result.mesh = std::move(made->mesh);
  return {std::move(result), made.diagnostics()};
}

ToleranceOptions many_lattices(int left_out) {
  constexpr int kPatience = 7;
  ToleranceOptions options;
  options.most_attempts = kPatience;
  options.left_out = left_out;
  return options;
}

Result<MesherResult> mesh_by_lattice(const ImplicitSurface& surface, const MesherRequest& request) {
  return mesh_on_cells(surface, request, many_lattices());
}

}  // namespace cs2mesh
