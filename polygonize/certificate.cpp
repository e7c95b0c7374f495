#include "polygonize/certificate.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/box_pairs.h"
#include "polygonize/check.h"
#include "polygonize/shell_prover.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// Triangles that share a restriction of the surface.
constexpr std::size_t kChunk = 64;
/// The shell reaches beyond where the surface seems to be by these parts of that distance and of
/// the tolerance: room for the bounds to show it.
constexpr double kRoom = 0.3, kLeast = 0.06;
/// Where that is not enough, it is made thicker, this often.
constexpr int kThickenings = 3;
constexpr double kThicker = 1.6;
/// Of the tolerance, for the rounding of lengths.
constexpr double kWhole = 1 - 1e-9;

Aabb box_of(const TriangleMesh& mesh, std::size_t triangle) {
  Aabb box;
  for (const Index v : mesh.triangles[triangle]) box.include(mesh.positions[v]);
  return box;
}

Vec3d centroid(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
}

/// All triangles, neighbours in number near each other in space.
std::vector<std::uint32_t> by_place(const TriangleMesh& mesh) {
  const Aabb all = bounds(mesh);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded(mesh.triangles.size());
  for (std::size_t t = 0; t < coded.size(); ++t) {
    coded[t] = {morton_code(all, centroid(mesh, t)), static_cast<std::uint32_t>(t)};
  }
  tbb::parallel_sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order;
  order.reserve(coded.size());
  for (const auto& [code, t] : coded) order.push_back(t);
  return order;
}

/// Sums of the normals of the triangles around each vertex.
std::vector<Vec3d> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3d> normals(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3d area = area_vector(mesh, t);
    if (!(norm(area) > 0)) continue;
    for (const Index v : mesh.triangles[t]) normals[v] += normalized(area);
  }
  return normals;
}

/// How far the surface seems to be outside and inside of a triangle.
struct Sag {
  double outer = 0.0, inner = 0.0;
};

class Certifier {
 public:
  Certifier(const ImplicitSurface& surface, const TriangleMesh& mesh, const CertifyOptions& options)
      : surface_(surface), mesh_(mesh), options_(options), order_(by_place(mesh)) {
    doubts_.assign(mesh.triangles.size(), Doubt::none);
  }

  /// False if cancelled.
  bool run() {
    if (!shape_shell()) return false;
    std::vector<std::uint32_t> todo = order_;
    for (int round = 0; !todo.empty(); ++round) {
      if (!look_at(todo)) return false;
      if (round == kThickenings) break;
      todo = thickened();
    }
    return true;
  }

  const std::vector<Doubt>& doubts() const { return doubts_; }
  const ProverCounts& counts() const { return counts_; }

 private:
  template <class F>
  bool for_each_chunk(std::span<const std::uint32_t> triangles, F&& f) {
    const std::size_t chunks = (triangles.size() + kChunk - 1) / kChunk;
    std::vector<ProverCounts> counts(chunks);
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t i) {
      if (cancelled(options_.progress)) return;
      f(triangles.subspan(kChunk * i, std::min(kChunk, triangles.size() - kChunk * i)), counts[i]);
    });
    for (const ProverCounts& c : counts) counts_ += c;
    return !cancelled(options_.progress);
  }

  /// Directions by the gradients at the vertices, lengths by the sag of the triangles around.
  bool shape_shell() {
    std::vector<Sag> sags(mesh_.triangles.size());
    std::vector<Vec3d> gradients(3 * mesh_.triangles.size());
    const auto measure = [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
      measure_sag(chunk, sags, gradients, counts);
    };
    if (!for_each_chunk(order_, measure)) return false;
    const std::size_t vertices = mesh_.positions.size();
    shell_.direction = vertex_normals(mesh_);
    shell_.outer.assign(vertices, kLeast * options_.tolerance);
    shell_.inner.assign(vertices, kLeast * options_.tolerance);
    std::vector<Vec3d> gradient(vertices);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index v = mesh_.triangles[t][k];
        gradient[v] = gradients[3 * t + k];
        for (const auto& [sag, length] : {std::pair(sags[t].outer, &shell_.outer[v]),
                                          std::pair(sags[t].inner, &shell_.inner[v])}) {
          const double wanted = (1 + kRoom) * sag + kLeast * options_.tolerance;
          *length = std::min(std::max(*length, wanted), kWhole * options_.tolerance);
        }
      }
    }
    for (std::size_t v = 0; v < vertices; ++v) choose_direction(v, gradient[v]);
    return true;
  }

  void choose_direction(std::size_t v, const Vec3d& gradient) {
    constexpr double kLeaning = 0.5;  // cosine from which on the gradient is not to be relied on
    const double length = norm(shell_.direction[v]);
    if (length > 0) shell_.direction[v] = shell_.direction[v] / length;
    const double slope = norm(gradient);
    if (-dot(gradient, shell_.direction[v]) > kLeaning * slope) {
      shell_.direction[v] = -gradient / slope;
    }
  }

  void measure_sag(std::span<const std::uint32_t> chunk, std::vector<Sag>& sags,
                   std::vector<Vec3d>& gradients, ProverCounts& counts) const {
    constexpr std::size_t kPoints = 7;
    Aabb box;
    std::vector<Vec3d> points;
    for (const std::uint32_t t : chunk) {
      box.include(box_of(mesh_, t));
      const auto& corners = mesh_.triangles[t];
      for (const Index v : corners) points.push_back(mesh_.positions[v]);
      for (std::size_t k = 0; k < 3; ++k) {
        points.push_back(0.5 *
                         (mesh_.positions[corners[k]] + mesh_.positions[corners[(k + 1) % 3]]));
      }
      points.push_back(centroid(mesh_, t));
    }
    const auto part = surface_.restrict_to(box);
    const HullBound bound = part->hull_bound(std::array{box.min, box.max}, {});
    std::vector<Jet> jets(points.size());
    part->jets(points, jets);
    counts.values += points.size();
    counts.gradients += points.size();
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      for (std::size_t k = 0; k < kPoints; ++k) {
        const Jet& jet = jets[kPoints * i + k];
        const Vec3d gradient = bound.gradient(jet);
        if (k < 3) gradients[3 * chunk[i] + k] = gradient;
        const double height = 0.5 * (bound.low(jet.value) + bound.high(jet.value)) / norm(gradient);
        Sag& sag = sags[chunk[i]];
        if (height > 0) sag.outer = std::max(sag.outer, height);
        if (height < 0) sag.inner = std::max(sag.inner, -height);
      }
    }
  }

  bool look_at(std::span<const std::uint32_t> triangles) {
    return for_each_chunk(
        triangles, [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
          const std::vector<Doubt> found = doubts_of(surface_, mesh_, shell_, chunk, counts);
          for (std::size_t i = 0; i < chunk.size(); ++i) doubts_[chunk[i]] = found[i];
        });
  }

  /// Makes the shell thicker around triangles whose distance is in doubt; returns those that this
  /// concerns.
  std::vector<std::uint32_t> thickened() {
    std::vector<bool> grows(mesh_.positions.size(), false), changed(mesh_.positions.size(), false);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (doubts_[t] != Doubt::distance) continue;
      for (const Index v : mesh_.triangles[t]) grows[v] = true;
    }
    const double most = kWhole * options_.tolerance;
    for (std::size_t v = 0; v < grows.size(); ++v) {
      if (!grows[v]) continue;
      for (double* length : {&shell_.outer[v], &shell_.inner[v]}) {
        if (*length >= most) continue;
        *length = std::min(kThicker * *length, most);
        changed[v] = true;
      }
    }
    std::vector<std::uint32_t> todo;
    for (const std::uint32_t t : order_) {
      const auto& c = mesh_.triangles[t];
      if (changed[c[0]] || changed[c[1]] || changed[c[2]]) todo.push_back(t);
    }
    return todo;
  }

  const ImplicitSurface& surface_;
  const TriangleMesh& mesh_;
  const CertifyOptions& options_;
  std::vector<std::uint32_t> order_;
  OffsetShell shell_;
  std::vector<Doubt> doubts_;
  ProverCounts counts_;
};

/// Puts triangles that reach into open cells in doubt; returns the cells that none reaches into.
std::vector<Aabb> doubt_topology(const TriangleMesh& mesh, std::span<const Aabb> open,
                                 std::vector<Doubt>& doubts) {
  if (open.empty()) return {};
  std::vector<Aabb> boxes(open.begin(), open.end());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) boxes.push_back(box_of(mesh, t));
  std::vector<bool> met(open.size(), false);
  const BoxPairs pairs(boxes);
  for (std::size_t group = 0; group < pairs.group_count(); ++group) {
    pairs.for_each_pair(group, [&](std::uint32_t i, std::uint32_t j) {
      const auto [cell, other] = std::minmax({i, j});
      if (cell >= open.size() || other < open.size()) return;
      met[cell] = true;
      Doubt& doubt = doubts[other - open.size()];
      if (doubt == Doubt::none) doubt = Doubt::topology;
    });
  }
  std::vector<Aabb> alone;
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (!met[i]) alone.push_back(open[i]);
  }
  return alone;
}

/// Whether the mesh has as many components and handles as the surface.
bool same_topology(const TriangleMesh& mesh, const TopologyProof& topology) {
  CheckOptions options;
  options.self_intersections = false;
  const MeshReport report = check(mesh, options);
  return report.closed && report.manifold_edges && report.manifold_vertices && report.oriented &&
         report.components == topology.components && report.genus == topology.genus;
}

void sum_up(const TriangleMesh& mesh, std::span<const Aabb> alone, Certificate& certificate) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area = norm(area_vector(mesh, t));
    certificate.area += area;
    if (certificate.doubts[t] == Doubt::none) {
      certificate.certified_area += area;
    } else {
      certificate.places.push_back(
          {centroid(mesh, t), certificate.doubts[t], area, box_of(mesh, t)});
    }
  }
  for (const Aabb& cell : alone) {
    certificate.places.push_back({cell.center(), Doubt::topology, 0.0, cell});
  }
}

}  // namespace

std::string_view name(Doubt doubt) {
  switch (doubt) {
    case Doubt::none:
      return "none";
    case Doubt::distance:
      return "distance";
    case Doubt::fold:
      return "fold";
    case Doubt::topology:
      return "topology";
    case Doubt::crease:
      return "crease";
  }
  return "none";
}

Result<Certificate> certify(const ImplicitSurface& surface, const TriangleMesh& mesh,
                            const TopologyProof& topology, const CertifyOptions& options) {
  require(options.tolerance > 0 && std::isfinite(options.tolerance),
          "certify: the tolerance must be positive");
  Certificate certificate;
  if (!mesh.empty()) {
    Certifier certifier(surface, mesh, options);
    if (!certifier.run()) return error_at({}, "interrupted", Failure::interrupted);
    certificate.doubts = certifier.doubts();
    certificate.values = certifier.counts().values;
    certificate.gradients = certifier.counts().gradients;
    certificate.bounds = certifier.counts().bounds;
  }
  const std::vector<Aabb> alone = doubt_topology(mesh, topology.open, certificate.doubts);
  if (!same_topology(mesh, topology)) {
    for (Doubt& doubt : certificate.doubts) {
      if (doubt == Doubt::none) doubt = Doubt::topology;
    }
  }
  sum_up(mesh, alone, certificate);
  return certificate;
}

}  // namespace cs2mesh
