#include "polygonize/certificate.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/box_pairs.h"
#include "polygonize/mesh_components.h"
#include "polygonize/shell_prover.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// Triangles that share a restriction of the surface.
constexpr std::size_t kChunk = 64;
/// The shell reaches beyond where the surface seems to be by these parts of that distance and of
/// the tolerance: room for the bounds to show it.
constexpr double kRoom = 0.2, kLeast = 0.03;
/// At first not beyond this part of the tolerance: the estimate may be far too large.
constexpr double kMostAtFirst = 0.7;
/// Where that is not enough, it is made thicker, this often.
constexpr int kThickenings = 6;
constexpr double kThicker = 1.5;
/// Of the tolerance, for the rounding of lengths.
constexpr double kWhole = 1 - 1e-9;

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

/// What there is of a triangle: how far the surface seems to be outside and inside of it, and unit
/// normals, its own and those of the surface at some points.
struct Look {
  double outer = 0.0, inner = 0.0;
  std::array<Vec3d, 8> normals;
};

/// For each vertex a unit direction that leaves the triangles around and the surface near them as
/// steeply as can be: begun with the mean of the normals, then drawn towards whichever is farthest.
std::vector<Vec3d> steepest_directions(const TriangleMesh& mesh, std::span<const Look> looks) {
  constexpr int kRounds = 12;
  std::vector<Vec3d> directions(mesh.positions.size());
  for (std::size_t t = 0; t < looks.size(); ++t) {
    for (const Index v : mesh.triangles[t]) directions[v] += looks[t].normals[0];
  }
  const auto normalize_all = [&directions] {
    for (Vec3d& d : directions) {
      if (norm(d) > 0) d = normalized(d);
    }
  };
  normalize_all();
  for (int round = 1; round <= kRounds; ++round) {
    std::vector<double> least(directions.size(), 2.0);
    std::vector<Vec3d> farthest(directions.size());
    for (std::size_t t = 0; t < looks.size(); ++t) {
      for (const Index v : mesh.triangles[t]) {
        for (const Vec3d& normal : looks[t].normals) {
          const double cosine = dot(normal, directions[v]);
          if (cosine < least[v]) least[v] = cosine, farthest[v] = normal;
        }
      }
    }
    for (std::size_t v = 0; v < least.size(); ++v) directions[v] += (0.5 / round) * farthest[v];
    normalize_all();
  }
  return directions;
}

class Certifier {
 public:
  Certifier(const ImplicitSurface& surface, const TriangleMesh& mesh, const CertifyOptions& options)
      : surface_(surface), mesh_(mesh), options_(options), order_(by_place(mesh)) {
    findings_.assign(mesh.triangles.size(), {});
  }

  /// False if cancelled.
  bool run() {
    if (!shape_shell()) return false;
    std::vector<std::uint32_t> open = order_;
    for (int round = 0; !open.empty(); ++round) {
      if (!look_at(open, Question::signs)) return false;
      if (round == kThickenings) break;
      open = thickened();
    }
    open.clear();
    for (const std::uint32_t t : order_) {
      if (findings_[t].doubt == Doubt::none) open.push_back(t);
    }
    if (!look_at(open, Question::slopes)) return false;
    settle_folds();
    return true;
  }

  std::vector<Doubt> doubts() const {
    std::vector<Doubt> doubts;
    for (const Finding& finding : findings_) doubts.push_back(finding.doubt);
    return doubts;
  }
  const OffsetShell& shell() const { return shell_; }
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

  /// Lengths by the sag of the triangles around.
  bool shape_shell() {
    std::vector<Look> looks(mesh_.triangles.size());
    const auto measure = [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
      look_around(chunk, looks, counts);
    };
    if (!for_each_chunk(order_, measure)) return false;
    const std::size_t vertices = mesh_.positions.size();
    shell_.direction = steepest_directions(mesh_, looks);
    shell_.outer.assign(vertices, kLeast * options_.tolerance);
    shell_.inner.assign(vertices, kLeast * options_.tolerance);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (const Index v : mesh_.triangles[t]) {
        for (const auto& [sag, length] : {std::pair(looks[t].outer, &shell_.outer[v]),
                                          std::pair(looks[t].inner, &shell_.inner[v])}) {
          const double wanted = (1 + kRoom) * sag + kLeast * options_.tolerance;
          *length = std::max(*length, std::min(wanted, kMostAtFirst * options_.tolerance));
        }
      }
    }
    return true;
  }

  void look_around(std::span<const std::uint32_t> chunk, std::vector<Look>& looks,
                   ProverCounts& counts) const {
    constexpr std::size_t kPoints = 7;
    Aabb box;
    std::vector<Vec3d> points;
    for (const std::uint32_t t : chunk) {
      box.include(bounds(mesh_, t));
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
      const Vec3d area = area_vector(mesh_, chunk[i]);
      if (norm(area) > 0) looks[chunk[i]].normals[0] = normalized(area);
      for (std::size_t k = 0; k < kPoints; ++k) {
        const Jet& jet = jets[kPoints * i + k];
        const Vec3d gradient = bound.gradient(jet);
        const double height = 0.5 * (bound.low(jet.value) + bound.high(jet.value)) / norm(gradient);
        Look& look = looks[chunk[i]];
        if (norm(gradient) > 0) look.normals[k + 1] = -normalized(gradient);
        if (height > 0) look.outer = std::max(look.outer, height);
        if (height < 0) look.inner = std::max(look.inner, -height);
      }
    }
  }

  bool look_at(std::span<const std::uint32_t> triangles, Question question) {
    return for_each_chunk(triangles,
                          [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
                            const std::vector<Finding> found =
                                look_into(surface_, mesh_, shell_, chunk, question, counts);
                            for (std::size_t i = 0; i < chunk.size(); ++i)
                              findings_[chunk[i]] = found[i];
                          });
  }

  /// Makes the shell thicker around triangles whose distance is in doubt; returns those that this
  /// concerns.
  std::vector<std::uint32_t> thickened() {
    std::vector<bool> changed(mesh_.positions.size(), false);
    std::vector<bool> outer = changed, inner = changed;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (const Index v : mesh_.triangles[t]) {
        if (findings_[t].outer) outer[v] = true;
        if (findings_[t].inner) inner[v] = true;
      }
    }
    const double most = kWhole * options_.tolerance;
    const auto thicken = [&](std::size_t v, double& length) {
      if (length >= most) return;
      length = std::min(kThicker * length, most);
      changed[v] = true;
    };
    for (std::size_t v = 0; v < changed.size(); ++v) {
      if (outer[v]) thicken(v, shell_.outer[v]);
      if (inner[v]) thicken(v, shell_.inner[v]);
    }
    std::vector<std::uint32_t> open;
    for (const std::uint32_t t : order_) {
      const auto& c = mesh_.triangles[t];
      if (changed[c[0]] || changed[c[1]] || changed[c[2]]) open.push_back(t);
    }
    return open;
  }

  /// Where the gradients leave open whether layers can meet, their prisms tell: those of neighbours
  /// are on different sides of their border, and the others are to be apart.
  void settle_folds() {
    const auto hangs = [this](std::size_t t) {
      return findings_[t].doubt == Doubt::fold && findings_[t].rises;
    };
    const std::size_t count = mesh_.triangles.size();
    std::vector<char> apart(count, 0);
    for (std::size_t t = 0; t < count; ++t) apart[t] = hangs(t) ? 1 : 0;
    if (std::none_of(apart.begin(), apart.end(), [](char a) { return a != 0; })) return;
    std::vector<Aabb> boxes(count);
    for (std::size_t t = 0; t < count; ++t) {
      for (const Vec3d& p : prism_corners(mesh_, shell_, t)) boxes[t].include(p);
    }
    const BoxPairs pairs(boxes);
    for (std::size_t group = 0; group < pairs.group_count(); ++group) {
      pairs.for_each_pair(group, [&](std::uint32_t a, std::uint32_t b) {
        if ((apart[a] == 0 && apart[b] == 0) || share_a_corner(a, b)) return;
        if (are_apart(prism_corners(mesh_, shell_, a), prism_corners(mesh_, shell_, b))) return;
        apart[a] = apart[b] = 0;
      });
    }
    for (std::size_t t = 0; t < count; ++t) {
      if (apart[t] != 0) findings_[t] = {};
    }
  }

  bool share_a_corner(std::uint32_t a, std::uint32_t b) const {
    for (const Index v : mesh_.triangles[a]) {
      const auto& corners = mesh_.triangles[b];
      if (std::find(corners.begin(), corners.end(), v) != corners.end()) return true;
    }
    return false;
  }

  const ImplicitSurface& surface_;
  const TriangleMesh& mesh_;
  const CertifyOptions& options_;
  std::vector<std::uint32_t> order_;
  OffsetShell shell_;
  std::vector<Finding> findings_;
  ProverCounts counts_;
};

/// Puts triangles that reach into open cells in doubt; returns the cells that none reaches into.
std::vector<Aabb> doubt_topology(const TriangleMesh& mesh, std::span<const Aabb> open,
                                 std::vector<Doubt>& doubts) {
  if (open.empty()) return {};
  std::vector<Aabb> boxes(open.begin(), open.end());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) boxes.push_back(bounds(mesh, t));
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

bool leaves_sign_open(Doubt doubt) {
  return doubt == Doubt::distance || doubt == Doubt::crease;
}

/// Regions that the mesh does not account for: it parts space in one more than it has components.
/// The layers of the shell are of one region as far as their triangles are certified.
std::vector<Aabb> lost_regions(const TriangleMesh& mesh, const TopologyProof& topology,
                               const OffsetShell& shell, std::span<const Doubt> doubts) {
  TopologyProof::KnownPoints known;
  const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    known.points.push_back(mesh.positions[v] + shell.outer[v] * shell.direction[v]);
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    known.points.push_back(mesh.positions[v] - shell.inner[v] * shell.direction[v]);
  }
  known.inside.assign(inner, false);
  known.inside.resize(known.points.size(), true);
  std::vector<bool> certified(mesh.positions.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (leaves_sign_open(doubts[t])) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    certified[a] = certified[b] = certified[c] = true;
    for (const std::uint32_t first : {0U, inner}) {
      known.together.push_back({first + a, first + b});
      known.together.push_back({first + a, first + c});
    }
  }
  // Nothing is known of vertices without a certified triangle.
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < certified.size(); ++v) {
    if (certified[v]) continue;
    known.points[v] = known.points[inner + v] = {kNowhere, kNowhere, kNowhere};
  }
  std::vector<TopologyProof::Region> regions = topology.regions(known);
  // Those that hold nothing of the shell first.
  std::stable_sort(regions.begin() + 1, regions.end(),
                   [](const auto& a, const auto& b) { return a.known < b.known; });
  const std::size_t expected = components(mesh).size() + 1;
  std::size_t count = regions.size() > expected ? regions.size() - expected : 0;
  // A component in doubt may stand for none, and so make up for one that the mesh lacks.
  if (std::any_of(doubts.begin(), doubts.end(), leaves_sign_open)) {
    const auto is_unknown = [](const auto& region) { return !region.known; };
    const auto unknown = std::count_if(regions.begin() + 1, regions.end(), is_unknown);
    count = std::max(count, static_cast<std::size_t>(unknown));
  }
  std::vector<Aabb> lost;
  for (std::size_t i = 1; i <= count; ++i) lost.push_back(regions[i].leaf);
  return lost;
}

void sum_up(const TriangleMesh& mesh, std::span<const Aabb> cells, Certificate& certificate) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area = norm(area_vector(mesh, t));
    certificate.area += area;
    if (certificate.doubts[t] == Doubt::none) {
      certificate.certified_area += area;
    } else {
      certificate.places.push_back(
          {centroid(mesh, t), certificate.doubts[t], area, bounds(mesh, t)});
    }
  }
  for (const Aabb& cell : cells) {
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
  OffsetShell shell;
  if (!mesh.empty()) {
    Certifier certifier(surface, mesh, options);
    if (!certifier.run()) return error_at({}, "interrupted", Failure::interrupted);
    certificate.doubts = certifier.doubts();
    certificate.values = certifier.counts().values;
    certificate.gradients = certifier.counts().gradients;
    certificate.bounds = certifier.counts().bounds;
    shell = certifier.shell();
  }
  std::vector<Aabb> cells = lost_regions(mesh, topology, shell, certificate.doubts);
  const std::vector<Aabb> alone = doubt_topology(mesh, topology.open(), certificate.doubts);
  cells.insert(cells.end(), alone.begin(), alone.end());
  sum_up(mesh, cells, certificate);
  return certificate;
}

}  // namespace cs2mesh
