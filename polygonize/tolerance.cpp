#include "polygonize/tolerance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/metrology.h"
#include "polygonize/surface_projection.h"

namespace cs2mesh {
namespace {

/// Triangles measured together through one restriction of F: neighbours in the mesh's order.
constexpr std::size_t kChunk = 128;

struct Sample {
  double distance = 0.0;
  std::size_t triangle = 0;
};

/// The point of a triangle that is farthest from a sphere through its corners: the circumcentre if
/// the triangle is acute, else the middle of its longest side.
Vec3d sample_point(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  double side[3];  // squared length, opposite to the corner
  for (std::size_t i = 0; i < 3; ++i) side[i] = squared_norm(p[(i + 2) % 3] - p[(i + 1) % 3]);
  const double all = side[0] + side[1] + side[2];
  // Barycentric weights a^2 (b^2 + c^2 - a^2) of the circumcentre.
  double weight[3];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(2 * side[i] < all)) return 0.5 * (p[(i + 1) % 3] + p[(i + 2) % 3]);
    weight[i] = side[i] * (all - 2 * side[i]);
  }
  const double sum = weight[0] + weight[1] + weight[2];
  return (weight[0] / sum) * p[0] + (weight[1] / sum) * p[1] + (weight[2] / sum) * p[2];
}

/// |F| / |grad F|, or `otherwise` where the gradient does not tell.
double first_order_distance(const Jet& jet, double otherwise) {
  if (jet.value == 0) return 0.0;
  const double distance = std::abs(jet.value) / norm(jet.gradient);
  return distance <= otherwise ? distance : otherwise;
}

/// First-order distances of all samples; none is larger than the chunk it is in.
std::vector<Sample> first_order_distances(const ImplicitSurface& surface,
                                          const TriangleMesh& mesh) {
  std::vector<Sample> samples(mesh.triangles.size());
  const std::size_t chunks = (mesh.triangles.size() + kChunk - 1) / kChunk;
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    const std::size_t first = kChunk * chunk;
    const std::size_t last = std::min(first + kChunk, samples.size());
    std::vector<Vec3d> points;
    Aabb box;
    for (std::size_t i = first; i < last; ++i) {
      points.push_back(sample_point(mesh, i));
      box.include(points.back());
    }
    std::vector<Jet> jets(points.size());
    surface.restrict_to(box)->jets(points, jets);
    for (std::size_t i = first; i < last; ++i) {
      samples[i] = {first_order_distance(jets[i - first], box.diagonal()), i};
    }
  });
  return samples;
}

/// The distance of `p` from the surface by Newton's method along the gradient, if that converges
/// within `first`.
std::optional<double> newton_distance(const ImplicitSurface& surface, const Vec3d& p,
                                      double first) {
  constexpr int kMostSteps = 20;
  constexpr double kConverged = 1e-3;  // of the distance
  Vec3d q = p;
  for (int i = 0; i < kMostSteps; ++i) {
    const Jet jet = surface.jet(q);
    const double slope = squared_norm(jet.gradient);
    if (!(slope > 0)) return std::nullopt;
    const Vec3d step = (-jet.value / slope) * jet.gradient;
    q += step;
    const double distance = norm(q - p);
    if (!(distance <= 4 * first)) return std::nullopt;
    if (norm(step) <= kConverged * distance) return distance;
  }
  return std::nullopt;
}

/// An upper bound of the distance of `p` from the surface, as far as one is found: Newton's method
/// may run past a wall that is nearer, so both are tried.
double looked_at_distance(const ImplicitSurface& surface, const Vec3d& p, double first) {
  return searched_distance(surface, p, newton_distance(surface, p, first).value_or(first));
}

/// A mesh is taken when its estimate, which looks at one point of each triangle and at some points
/// of the surface, is this share of the tolerance.
constexpr double kAccept = 0.92;

/// The next cell to try: the error goes like a power of the cell, 2 for smooth surfaces that are
/// well resolved, which they are not yet on the pilot's cell, 1 at creases; from the second attempt
/// on as measured.
double next_cell(const std::vector<ToleranceAttempt>& attempts, bool creased, double tolerance) {
  constexpr double kAim = 0.8 * kAccept;  // of the tolerance
  const ToleranceAttempt& last = attempts.back();
  double order = creased ? 1.0 : 1.5;
  if (attempts.size() > 1) {
    const ToleranceAttempt& before = attempts[attempts.size() - 2];
    const double measured = std::log(before.error / last.error) / std::log(before.cell / last.cell);
    if (std::isfinite(measured)) order = std::clamp(measured, 0.7, 2.0);
  }
  const double ratio = kAim * tolerance / last.error;
  return last.cell * std::clamp(std::pow(ratio, 1 / order), 0.25, 0.9);
}

Diagnostic not_reached(double tolerance, const ToleranceMesh& best) {
  std::ostringstream text;
  text << "the tolerance " << tolerance << " was not reached: the mesh is within " << best.error
       << " of the surface (cell " << best.cell << ")";
  return {Severity::warning, Failure::tolerance, {}, text.str()};
}

}  // namespace

double GradientEstimate::largest_distance(const ImplicitSurface& surface,
                                          const TriangleMesh& mesh) const {
  std::vector<Sample> samples = first_order_distances(surface, mesh);
  if (samples.empty()) return 0.0;

  // The first order errs far from the surface, near creases and between walls: look closely at the
  // farthest, until none of the others can be farther than what was found.
  constexpr std::size_t kBatch = 256;
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.triangle < b.triangle;
  });
  double largest = 0.0;
  std::vector<double> distances(kBatch);
  for (std::size_t first = 0; first < samples.size() && samples[first].distance > largest;
       first += kBatch) {
    const std::size_t count = std::min(kBatch, samples.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const Sample& sample = samples[first + i];
      distances[i] =
          looked_at_distance(surface, sample_point(mesh, sample.triangle), sample.distance);
    });
    const auto end = distances.begin() + static_cast<std::ptrdiff_t>(count);
    largest = std::max(largest, *std::max_element(distances.begin(), end));
  }
  return largest;
}

double TwoSidedEstimate::largest_distance(const ImplicitSurface& surface,
                                          const TriangleMesh& mesh) const {
  const double forth = GradientEstimate().largest_distance(surface, mesh);
  if (forth > enough_) return forth;
  MeasureOptions options;
  options.samples = samples_;
  options.mesh_to_surface = false;
  return std::max(forth, measure(surface, mesh, options).surface_to_mesh_max);
}

double expected_cell(double radius, bool creased, double tolerance) {
  constexpr double kSagitta = 0.3;
  constexpr double kAim = 0.8;        // of the tolerance
  constexpr double kFollow = 0.7;     // of the radius: at least three cells across
  constexpr double kCreaseCells = 2;  // tolerances in a cell
  double cell = std::min(std::sqrt(kAim * tolerance * radius / kSagitta), kFollow * radius);
  if (creased) cell = std::min(cell, kCreaseCells * tolerance);
  return cell;
}

Result<ToleranceMesh> mesh_to_tolerance(const ImplicitSurface& surface, double thinnest_radius,
                                        bool creased, double tolerance,
                                        const ToleranceOptions& options) {
  require(thinnest_radius > 0 && std::isfinite(thinnest_radius),
          "mesh_to_tolerance: the radius must be positive");
  require(tolerance > 0 && std::isfinite(tolerance),
          "mesh_to_tolerance: the tolerance must be positive");
  require(options.most_attempts >= 1, "mesh_to_tolerance: at least one attempt");
  constexpr std::size_t kSurfaceSamples = 100'000;
  const TwoSidedEstimate two_sided(kAccept * tolerance, kSurfaceSamples);
  const DistanceEstimate& estimate = options.estimate != nullptr ? *options.estimate : two_sided;

  // The radius is that of the thinnest element, the surface may curve less or more. A pilot on
  // twice the cell costs a quarter, and may do.
  constexpr double kPilot = 2.0;
  const double shape_cell = expected_cell(thinnest_radius, false, HUGE_VAL);
  double cell = std::min(kPilot * expected_cell(thinnest_radius, creased, tolerance), shape_cell);
  if (options.most_attempts == 1) cell = expected_cell(thinnest_radius, creased, tolerance);

  ToleranceMesh best;
  std::vector<ToleranceAttempt> attempts;
  std::vector<Diagnostic> remarks;
  for (int attempt = 0; attempt < options.most_attempts; ++attempt) {
    LatticeStatistics statistics;
    Result<TriangleMesh> mesh = mesh_lattice(
        surface, {cell, options.origin, options.max_nodes, options.max_triangles, options.progress},
        &statistics);
    if (!mesh) {
      if (attempts.empty() || mesh.diagnostics().front().failure == Failure::interrupted) {
        return Result<ToleranceMesh>::failure(mesh.diagnostics());
      }
      remarks = mesh.diagnostics();
      for (Diagnostic& remark : remarks) remark.severity = Severity::warning;
      break;
    }
    const double error = estimate.largest_distance(surface, *mesh);
    attempts.push_back({cell, error, mesh->triangles.size()});
    if (attempts.size() == 1 || error < best.error) {
      best.mesh = *std::move(mesh);
      best.cell = cell;
      best.error = error;
      best.statistics = statistics;
    }
    if (error <= kAccept * tolerance) break;
    cell = next_cell(attempts, creased, tolerance);
  }
  best.attempts = std::move(attempts);
  best.reached = best.error <= tolerance;
  if (!best.reached) remarks.push_back(not_reached(tolerance, best));
  return {std::move(best), std::move(remarks)};
}

}  // namespace cs2mesh
