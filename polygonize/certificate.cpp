#include "polygonize/certificate.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/box_pairs.h"
#include "polygonize/check.h"
#include "polygonize/longest_edge_cuts.h"
#include "polygonize/mesh_components.h"
#include "polygonize/near_intersections.h"
#include "polygonize/refine.h"
#include "polygonize/shell_certifier.h"
#include "polygonize/unfold.h"

namespace cs2mesh {
namespace {

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
  return doubt != Doubt::none && doubt != Doubt::fold && doubt != Doubt::topology;
}

/// Regions that the mesh does not account for: it parts space in one more than it has components.
/// The layers of the shell are of one region as far as their triangles are certified.
std::vector<Aabb> lost_regions(const TriangleMesh& mesh, const TopologyProof& topology,
                               const OffsetShell& shell, std::span<const Doubt> doubts) {
  TopologyProof::KnownPoints known;
  const auto inner = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t v = 0; v < inner; ++v) known.points.push_back(shell.outer_place(mesh, v));
  for (std::uint32_t v = 0; v < inner; ++v) known.points.push_back(shell.inner_place(mesh, v));
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

/// Adds up the area, and lists what of each triangle is in doubt.
void sum_up(const FlatParts& parts, std::span<const Doubt> doubts, Certificate& certificate) {
  const TriangleMesh& mesh = parts.mesh;
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    const double area = norm(area_vector(mesh, i));
    const std::uint32_t t = parts.whole[i];
    certificate.area += area;
    if (doubts[i] == Doubt::none) {
      certificate.certified_area += area;
      continue;
    }
    // Parts of a triangle come one after the other.
    if (certificate.doubts[t] == Doubt::none) {
      certificate.doubts[t] = doubts[i];
      certificate.places.push_back({{}, doubts[i], 0.0, {}});
    }
    UncertifiedPlace& place = certificate.places.back();
    place.area += area;
    for (const auto v : mesh.triangles[i]) place.box.include(mesh.positions[v]);
    place.position += (area / place.area) * (centroid(mesh, i) - place.position);
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
    case Doubt::profile:
      return "profile";
  }
  return "none";
}

namespace {

/// What is known of a mesh by its triangles, or by parts of them that lie in them: these have
/// shells of their own, which follow the surface more closely, and prove the same of the same set
/// of points.
struct Proof {
  FlatParts parts;
  ShellCertifier certifier;  ///< has looked at the parts
};

Certificate certificate_of(const TriangleMesh& mesh, const Proof& proof,
                           const TopologyProof& topology) {
  Certificate certificate;
  certificate.values = proof.certifier.counts().values;
  certificate.gradients = proof.certifier.counts().gradients;
  certificate.bounds = proof.certifier.counts().bounds;
  std::vector<Doubt> doubts = proof.certifier.doubts();
  std::vector<Aabb> cells =
      lost_regions(proof.parts.mesh, topology, proof.certifier.shell(), doubts);
  const std::vector<Aabb> alone = doubt_topology(proof.parts.mesh, topology.open(), doubts);
  cells.insert(cells.end(), alone.begin(), alone.end());
  certificate.doubts.assign(mesh.triangles.size(), Doubt::none);
  sum_up(proof.parts, doubts, certificate);
  for (const Aabb& cell : cells) {
    certificate.places.push_back({cell.center(), Doubt::topology, 0.0, cell});
  }
  return certificate;
}

/// That of the triangles that may be certified once they are smaller.
double area_in_doubt(const TriangleMesh& mesh, const ShellCertifier& certifier) {
  const std::vector<Doubt> doubts = certifier.doubts();
  double area = 0.0;
  for (std::size_t t = 0; t < doubts.size(); ++t) {
    if (may_be_cut(doubts[t])) {
      area += norm(area_vector(mesh, t));
    }
  }
  return area;
}
double area_in_doubt(const Proof& proof) {
  return area_in_doubt(proof.parts.mesh, proof.certifier);
}

/// A proof of a mesh that the certifier has looked at: what is in doubt is cut flat, as long as
/// that helps. None if the user wants to stop.
std::optional<Proof> prove_in_parts(const TriangleMesh& mesh, const ShellCertifier& certifier) {
  constexpr int kMostRounds = 8, kPatience = 2;
  constexpr double kWorthIt = 0.9;
  constexpr std::size_t kMostGrowth = 4, kMore = 10'000;
  const std::size_t most = kMostGrowth * mesh.triangles.size() + kMore;
  Proof best{{mesh, {}}, certifier};
  best.parts.whole.resize(mesh.triangles.size());
  std::iota(best.parts.whole.begin(), best.parts.whole.end(), 0U);
  Proof last = best;
  double least = area_in_doubt(best);
  int vain = 0;
  for (int round = 0; round < kMostRounds && least > 0 && vain < kPatience; ++round) {
    const std::vector<std::uint32_t> triangles = last.certifier.worth_cutting_flat();
    if (triangles.empty()) break;
    FlatParts parts = cut_flat(last.parts.mesh, triangles);
    if (parts.mesh.triangles.size() > most) break;
    for (std::uint32_t& t : parts.whole) t = last.parts.whole[t];
    last.parts = std::move(parts);
    if (!last.certifier.run(last.parts.mesh)) return std::nullopt;
    ++vain;
    const double left = area_in_doubt(last);
    if (left > kWorthIt * least) continue;
    best = last;
    least = left;
    vain = 0;
  }
  return best;
}

/// The triangles of whose parts some are worth cutting.
std::vector<std::uint32_t> worth_cutting(const Proof& proof) {
  std::vector<std::uint32_t> triangles;
  for (const std::uint32_t i : proof.certifier.worth_cutting()) {
    triangles.push_back(proof.parts.whole[i]);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

/// Cuts these triangles through the middle of their longest edges, and others as it takes.
TriangleMesh cut(const ImplicitSurface& surface, const TriangleMesh& mesh,
                 const std::vector<std::uint32_t>& triangles, const CertifyOptions& options) {
  constexpr double kAlways = 1e-12;  // too far, however near
  const std::vector<bool> close(mesh.positions.size(), true);
  RefineOptions refinement;
  refinement.tolerance = options.tolerance;
  refinement.most_rounds = 1;
  refinement.first_looked_at = &triangles;
  refinement.close = &close;
  refinement.closer = kAlways * options.tolerance;
  return refine(surface, mesh, refinement);
}

/// The triangles that cross others near some that are new; if there are none, those that do once
/// rounded to floats, as files have them.
template <class IsNew>
std::vector<std::uint32_t> crossing_near(const TriangleMesh& mesh, const IsNew& is_new) {
  constexpr std::size_t kMostPairs = 1000;
  const auto look = [&](const TriangleMesh& as) {
    std::vector<Aabb> boxes;
    for (std::size_t t = 0; t < as.triangles.size(); ++t) {
      if (is_new(t)) boxes.push_back(bounds(as, t));
    }
    std::vector<std::uint32_t> triangles;
    for (const auto& pair : find_intersections_near(as, std::move(boxes), kMostPairs).pairs) {
      triangles.insert(triangles.end(), pair.begin(), pair.end());
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    return triangles;
  };
  std::vector<std::uint32_t> triangles = look(mesh);
  if (triangles.empty()) triangles = look(rounded_to_float(mesh));
  return triangles;
}

/// Flips edges of triangles that turn their back on the surface, unless that does harm.
void flip_edges(TriangleMesh& mesh, ShellCertifier& certifier) {
  TriangleMesh flipped = mesh;
  if (unfold(flipped, certifier.normals()) == 0) return;
  const auto is_new = [&](std::size_t t) { return flipped.triangles[t] != mesh.triangles[t]; };
  if (!crossing_near(flipped, is_new).empty()) return;
  ShellCertifier then = certifier;
  if (!then.run(flipped)) return;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_new(t) && !then.seems_near(t)) return;
  }
  if (!(area_in_doubt(flipped, then) < area_in_doubt(mesh, certifier))) return;
  mesh = std::move(flipped);
  certifier = std::move(then);
}

/// Those of some triangles that are near none of some of another mesh.
std::vector<std::uint32_t> away_from(const TriangleMesh& mesh,
                                     std::span<const std::uint32_t> triangles,
                                     const TriangleMesh& other,
                                     std::span<const std::uint32_t> avoided) {
  std::vector<Aabb> boxes;
  for (const std::uint32_t t : avoided) {
    const Aabb box = bounds(other, t);
    boxes.push_back(box.grown(box.diagonal()));
  }
  std::vector<std::uint32_t> away;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(away), [&](std::uint32_t t) {
    const Aabb own = bounds(mesh, t);
    return std::none_of(boxes.begin(), boxes.end(),
                        [&](const Aabb& box) { return box.overlaps(own); });
  });
  return away;
}

/// As cut(), but without triangles that cross. What would come to cross others is cut further, with
/// these, and if that does not help is left as it was.
TriangleMesh cut_without_crossing(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                  std::vector<std::uint32_t> triangles,
                                  const CertifyOptions& options) {
  constexpr int kMostCuts = 2, kMostTries = 4;
  const auto first_new = static_cast<TriangleMesh::Index>(mesh.positions.size());
  for (int attempt = 0; attempt < kMostTries && !triangles.empty(); ++attempt) {
    TriangleMesh finer = cut(surface, mesh, triangles, options);
    const auto is_new = [&](std::size_t t) {
      const auto& corners = finer.triangles[t];
      return *std::max_element(corners.begin(), corners.end()) >= first_new;
    };
    std::vector<std::uint32_t> in_the_way = crossing_near(finer, is_new);
    for (int again = 0; again < kMostCuts && !in_the_way.empty(); ++again) {
      finer = cut(surface, finer, in_the_way, options);
      in_the_way = crossing_near(finer, is_new);
    }
    if (in_the_way.empty()) return finer;
    triangles = away_from(mesh, triangles, finer, in_the_way);
  }
  return mesh;
}

/// How many times as many triangles a mesh may come to have.
constexpr std::size_t kMostGrowth = 4;

using Triangle3 = std::array<TriangleMesh::Index, 3>;

/// The triangles that are proven, as wholes or in parts; sorted.
std::vector<Triangle3> settled_by(const TriangleMesh& mesh, const Proof& proof) {
  std::vector<char> open(mesh.triangles.size(), 0);
  const std::vector<Doubt> doubts = proof.certifier.doubts();
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    if (doubts[i] != Doubt::none) open[proof.parts.whole[i]] = 1;
  }
  std::vector<Triangle3> settled;
  for (std::size_t t = 0; t < open.size(); ++t) {
    if (open[t] == 0) settled.push_back(mesh.triangles[t]);
  }
  std::sort(settled.begin(), settled.end());
  return settled;
}

/// Cuts what a proof leaves in doubt some times before it asks of parts again: real cuts bring the
/// mesh nearer to the surface. What is settled stays, but beside what is not. False if the user
/// wants to stop.
bool cut_at_large(const ImplicitSurface& surface, TriangleMesh& mesh, ShellCertifier& certifier,
                  const Proof& proof, const CertifyOptions& options) {
  constexpr int kMostRounds = 5;
  constexpr double kMuch = 0.5, kWorthIt = 0.9;
  // Where parts do not help, neighbours have to be smaller as well.
  constexpr double kHelp = 1.0 / 3;
  const bool parts_help = area_in_doubt(proof) < kHelp * area_in_doubt(mesh, certifier);
  const std::vector<Triangle3> settled =
      parts_help ? settled_by(mesh, proof) : std::vector<Triangle3>{};
  const auto touches = [](const std::vector<char>& vertices, const Triangle3& corners) {
    return vertices[corners[0]] + vertices[corners[1]] + vertices[corners[2]] > 0;
  };
  const std::size_t most_triangles = kMostGrowth * mesh.triangles.size();
  std::vector<std::uint32_t> triangles =
      parts_help ? worth_cutting(proof) : certifier.worth_cutting();
  const double much = kMuch * (1 - options.enough) * area(mesh);
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && least > much; ++round) {
    TriangleMesh finer = cut_without_crossing(surface, mesh, triangles, options);
    const std::size_t count = finer.triangles.size();
    if (count == mesh.triangles.size() || count > most_triangles) break;
    ShellCertifier further = certifier;
    if (!further.run(finer)) return false;
    flip_edges(finer, further);
    const std::vector<Doubt> doubts = further.doubts();
    double left = 0.0;
    std::vector<char> open(finer.positions.size(), 0);  // vertices of what is neither
    for (std::size_t t = 0; t < doubts.size(); ++t) {
      const auto& corners = finer.triangles[t];
      if (!may_be_cut(doubts[t]) || std::binary_search(settled.begin(), settled.end(), corners)) {
        continue;
      }
      left += norm(area_vector(finer, t));
      for (const auto v : corners) open[v] = 1;
    }
    if (left > kWorthIt * least) break;
    mesh = std::move(finer);
    certifier = std::move(further);
    least = left;
    triangles = certifier.worth_cutting();
    std::erase_if(triangles, [&](std::uint32_t t) { return !touches(open, mesh.triangles[t]); });
  }
  return true;
}

Result<Certificate> interrupted() {
  return error_at({}, "interrupted", Failure::interrupted);
}

}  // namespace

Result<Certificate> certify(const ImplicitSurface& surface, const TriangleMesh& mesh,
                            const TopologyProof& topology, const CertifyOptions& options) {
  require(options.tolerance > 0 && std::isfinite(options.tolerance),
          "certify: the tolerance must be positive");
  ShellCertifier certifier(surface, options.tolerance, options.progress);
  if (!certifier.run(mesh)) return interrupted();
  const std::optional<Proof> proof = prove_in_parts(mesh, certifier);
  if (!proof) return interrupted();
  return certificate_of(mesh, *proof, topology);
}

Result<Certificate> certify_refined(const ImplicitSurface& surface, TriangleMesh& mesh,
                                    const TopologyProof& topology, const CertifyOptions& options) {
  require(options.tolerance > 0 && std::isfinite(options.tolerance),
          "certify_refined: the tolerance must be positive");
  // Rounds that leave much of the area in doubt are not worth it, but may lead to others that do
  // not; so the more is in doubt, the longer is that hoped for.
  constexpr int kPatience = 3;
  constexpr double kWorthIt = 0.8, kMuch = 0.005;
  const std::size_t most_triangles = kMostGrowth * mesh.triangles.size();
  ShellCertifier further(surface, options.tolerance, options.progress);
  if (!further.run(mesh)) return interrupted();
  std::optional<Proof> best = prove_in_parts(mesh, further);
  if (!best) return interrupted();
  const double whole = area(mesh), much = kMuch * whole;
  const double enough = (1 - options.enough) * whole;
  double least = area_in_doubt(*best);
  const Certificate uncut = certificate_of(mesh, *best, topology);
  if (least <= enough || least > (1 - options.hopeless) * whole) return uncut;
  // Rounds that do not help are taken back.
  const TriangleMesh before = mesh;
  TriangleMesh finer = mesh;
  flip_edges(finer, further);
  if (!cut_at_large(surface, finer, further, *best, options)) return interrupted();
  std::optional<Proof> cut_proof = prove_in_parts(finer, further);
  if (!cut_proof) return interrupted();
  Proof last = std::move(*cut_proof);
  if (area_in_doubt(last) < options.worth * least) {
    mesh = finer;
    best = last;
    least = area_in_doubt(last);
  }
  int vain = 0;
  for (int round = 0; round < options.rounds && least > enough; ++round) {
    if (vain == (least > much ? kPatience : 1)) break;
    TriangleMesh next = cut_without_crossing(surface, finer, worth_cutting(last), options);
    const std::size_t count = next.triangles.size();
    if (count == finer.triangles.size() || count > most_triangles) break;
    finer = std::move(next);
    if (!further.run(finer)) return interrupted();
    flip_edges(finer, further);
    std::optional<Proof> proof = prove_in_parts(finer, further);
    if (!proof) return interrupted();
    last = std::move(*proof);
    ++vain;
    const double left = area_in_doubt(last);
    if (left > kWorthIt * least) continue;
    mesh = finer;
    best = last;
    least = left;
    vain = 0;
  }
  // Nor does all of it where what is in doubt for other reasons outweighs what is cut away.
  const Certificate cut = certificate_of(mesh, *best, topology);
  if (1 - cut.share() < options.worth * (1 - uncut.share())) return cut;
  mesh = before;
  return uncut;
}

}  // namespace cs2mesh
