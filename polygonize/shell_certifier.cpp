#include "polygonize/shell_certifier.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "polygonize/place_order.h"

namespace cs2mesh {
namespace {

/// Triangles that share a restriction of the surface.
constexpr std::size_t kChunk = 8;
/// The shell reaches beyond where the surface seems to be by these parts of that distance and of
/// the tolerance: room for the bounds to show it.
constexpr double kRoom = 0.2, kLeast = 0.03;
/// At first not beyond this part of the tolerance: the estimate may be far too large.
constexpr double kMostAtFirst = 0.7;
/// Where that is not enough it is made thicker, and thinner where it ends beyond a gap, this often.
constexpr int kChanges = 8;
constexpr double kThicker = 1.5, kThinner = 0.5, kMuchRoom = 2.0;
/// Estimates of where the surface is over a point may be off by such a factor.
constexpr double kNearer = 0.75;
/// Of the tolerance, for the rounding of lengths.
constexpr double kWhole = 1 - 1e-9;

/// What counts as near by a few points, as of the mesher.
constexpr double kSeemsNear = 0.93;

constexpr char kOuter = 1, kInner = 2;

double longest_side(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3d &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  return std::max({norm(p - q), norm(q - r), norm(r - p)});
}

}  // namespace

bool ShellCertifier::run(const TriangleMesh& mesh) {
  if (progress_ != nullptr) progress_->report("certify", 0.0);
  take_over(mesh);
  if (!look_around()) return false;
  shape_shell();
  if (!prove_signs()) return false;
  for (Record& record : records_) {
    if (record.has_crossings || !record.signs.grows) continue;
    record.crossings = Doubt::none;
    record.has_crossings = true;
  }
  const auto is_near = [this](std::uint32_t t) {
    return records_[t].signs.doubt == Doubt::none && !records_[t].has_crossings;
  };
  if (!prove_growth(Question::crossings, those(is_near))) return false;
  for (Record& record : records_) {
    record.doubt = record.signs.doubt != Doubt::none ? record.signs.doubt : record.crossings;
    record.bent = false;
  }
  // Where prisms may meet, the gradients may tell that layers do not.
  const std::vector<std::uint32_t> doubtful = not_apart();
  std::vector<std::uint32_t> open;
  for (const std::uint32_t t : doubtful) {
    if (!records_[t].has_layers && records_[t].doubt == Doubt::none) open.push_back(t);
  }
  if (!prove_growth(Question::layers, open)) return false;
  for (const std::uint32_t t : doubtful) {
    if (records_[t].doubt == Doubt::none) records_[t].doubt = records_[t].layers;
    records_[t].bent = records_[t].doubt == Doubt::fold && records_[t].crossings == Doubt::none;
  }
  return true;
}

std::vector<Doubt> ShellCertifier::doubts() const {
  std::vector<Doubt> doubts;
  doubts.reserve(records_.size());
  for (const Record& record : records_) doubts.push_back(record.doubt);
  return doubts;
}

std::vector<Vec3d> ShellCertifier::normals() const {
  std::vector<Vec3d> normals(shell_.direction.size());
  for (std::size_t t = 0; t < records_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      normals[triangles_[t][k]] = records_[t].look.normals[k + 1];
    }
  }
  return normals;
}

bool ShellCertifier::seems_near(std::size_t triangle) const {
  const Look& look = records_[triangle].look;
  return std::max(look.outer, look.inner) < kSeemsNear * tolerance_;
}

/// A prism is bent by whoever made it thick where it is thickest; it is cut itself where it is wide
/// for that.
std::vector<std::uint32_t> ShellCertifier::worth_cutting() const {
  constexpr double kAlmost = 0.5, kWide = 2.0;
  std::vector<std::uint32_t> triangles;
  std::vector<char> thick(shell_.direction.size(), 0);
  const auto thickness = [this](Index v) { return std::max(shell_.outer[v], shell_.inner[v]); };
  for (std::uint32_t t = 0; t < records_.size(); ++t) {
    const Record& record = records_[t];
    if (!may_be_cut(record.doubt)) continue;
    const Index v =
        *std::max_element(triangles_[t].begin(), triangles_[t].end(),
                          [&](Index a, Index b) { return thickness(a) < thickness(b); });
    if (!record.bent || record.look.width > kWide * thickness(v)) triangles.push_back(t);
    if (record.bent) thick[v] |= shell_.outer[v] > shell_.inner[v] ? kOuter : kInner;
  }
  const auto sag_at = [&](std::uint32_t t, Index v) {
    return (thick[v] & kOuter) != 0 ? records_[t].look.outer : records_[t].look.inner;
  };
  std::vector<double> most(shell_.direction.size(), 0.0);
  for (std::uint32_t t = 0; t < records_.size(); ++t) {
    for (const Index v : triangles_[t]) {
      if (thick[v] != 0) most[v] = std::max(most[v], sag_at(t, v));
    }
  }
  for (std::uint32_t t = 0; t < records_.size(); ++t) {
    for (const Index v : triangles_[t]) {
      if (thick[v] != 0 && sag_at(t, v) >= kAlmost * most[v]) triangles.push_back(t);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

std::vector<std::uint32_t> ShellCertifier::worth_cutting_flat() const {
  std::vector<std::uint32_t> triangles = worth_cutting();
  std::erase_if(triangles, [this](std::uint32_t t) {
    const Look& look = records_[t].look;
    if (!(kNearer * std::max(look.outer, look.inner) < tolerance_)) return true;
    double thickness = 0.0;
    for (const Index v : triangles_[t])
      thickness = std::max({thickness, shell_.outer[v], shell_.inner[v]});
    if (look.width < thickness) return true;
    return std::none_of(look.normals.begin() + 1, look.normals.end(),
                        [&](const Vec3d& n) { return dot(n, look.normals[0]) > 0; });
  });
  return triangles;
}

void ShellCertifier::take_over(const TriangleMesh& mesh) {
  using Known = std::pair<std::array<Index, 3>, std::uint32_t>;
  std::vector<Known> known;
  known.reserve(triangles_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) known.emplace_back(triangles_[t], t);
  tbb::parallel_sort(known.begin(), known.end());
  std::vector<Record> records(mesh.triangles.size());
  fresh_.assign(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const auto at = std::lower_bound(known.begin(), known.end(), Known{corners, 0});
    if (at != known.end() && at->first == corners) {
      records[t] = records_[at->second];
    } else {
      for (const Index v : corners) fresh_[v] = 1;
    }
  }
  for (std::size_t t = 0; t < records.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (fresh_[a] + fresh_[b] + fresh_[c] > 0) records[t].forget_prism();
  }
  records_ = std::move(records);
  triangles_ = mesh.triangles;
  mesh_ = &mesh;
  order_ = triangles_by_place(mesh);
}

template <class F>
bool ShellCertifier::for_each_chunk(std::span<const std::uint32_t> triangles, F&& f) {
  const std::size_t chunks = (triangles.size() + kChunk - 1) / kChunk;
  std::vector<ProverCounts> counts(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t i) {
    if (cancelled(progress_)) return;
    f(triangles.subspan(kChunk * i, std::min(kChunk, triangles.size() - kChunk * i)), counts[i]);
  });
  for (const ProverCounts& c : counts) counts_ += c;
  return !cancelled(progress_);
}

template <class F>
std::vector<std::uint32_t> ShellCertifier::those(F&& holds) const {
  std::vector<std::uint32_t> found;
  std::copy_if(order_.begin(), order_.end(), std::back_inserter(found), holds);
  return found;
}

bool ShellCertifier::look_around() {
  const auto is_unseen = [this](std::uint32_t t) { return !records_[t].has_look; };
  return for_each_chunk(those(is_unseen), [this](std::span<const std::uint32_t> chunk,
                                                 ProverCounts& c) { look_around(chunk, c); });
}

void ShellCertifier::look_around(std::span<const std::uint32_t> chunk, ProverCounts& counts) {
  constexpr std::size_t kPoints = 7;
  const TriangleMesh& mesh = *mesh_;
  Aabb box;
  std::vector<Vec3d> points;
  for (const std::uint32_t t : chunk) {
    box.include(bounds(mesh, t));
    const auto& corners = mesh.triangles[t];
    for (const Index v : corners) points.push_back(mesh.positions[v]);
    for (std::size_t k = 0; k < 3; ++k) {
      points.push_back(0.5 * (mesh.positions[corners[k]] + mesh.positions[corners[(k + 1) % 3]]));
    }
    points.push_back(centroid(mesh, t));
  }
  const auto part = surface_->restrict_to(box);
  const HullBound bound = part->hull_bound(std::array{box.min, box.max}, {});
  std::vector<Jet> jets(points.size());
  part->jets(points, jets);
  counts.values += points.size();
  counts.gradients += points.size();
  for (std::size_t i = 0; i < chunk.size(); ++i) {
    Look look;
    look.width = longest_side(mesh, chunk[i]);
    const Vec3d area = area_vector(mesh, chunk[i]);
    if (norm(area) > 0) look.normals[0] = normalized(area);
    for (std::size_t k = 0; k < kPoints; ++k) {
      const Jet& jet = jets[kPoints * i + k];
      const Vec3d gradient = bound.gradient(jet);
      const double height = 0.5 * (bound.low(jet.value) + bound.high(jet.value)) / norm(gradient);
      if (norm(gradient) > 0) look.normals[k + 1] = -normalized(gradient);
      if (height > 0) look.outer = std::max(look.outer, height);
      if (height < 0) look.inner = std::max(look.inner, -height);
      if (k < 3) look.height[k] = height;
    }
    records_[chunk[i]].look = look;
    records_[chunk[i]].has_look = true;
  }
}

/// Gives each fresh vertex a unit direction that leaves the triangles around and the surface near
/// them as steeply as can be: begun with the mean of the normals, then drawn towards whichever is
/// farthest.
void ShellCertifier::point_steeply() {
  constexpr int kRounds = 12;
  std::vector<Vec3d>& directions = shell_.direction;
  directions.resize(mesh_->positions.size());
  // The triangles of fresh vertices, and which of their corners those are.
  std::vector<std::pair<std::uint32_t, std::uint8_t>> corners;
  for (std::uint32_t t = 0; t < records_.size(); ++t) {
    for (std::uint8_t k = 0; k < 3; ++k) {
      if (fresh_[triangles_[t][k]] != 0) corners.emplace_back(t, k);
    }
  }
  for (const auto& [t, k] : corners) directions[triangles_[t][k]] = {};
  for (const auto& [t, k] : corners) directions[triangles_[t][k]] += records_[t].look.normals[0];
  const auto normalize_all = [&] {
    for (std::size_t v = 0; v < directions.size(); ++v) {
      if (fresh_[v] != 0 && norm(directions[v]) > 0) directions[v] = normalized(directions[v]);
    }
  };
  normalize_all();
  std::vector<double> least(directions.size());
  std::vector<Vec3d> farthest(directions.size());
  for (int round = 1; round <= kRounds; ++round) {
    std::fill(least.begin(), least.end(), 2.0);
    std::fill(farthest.begin(), farthest.end(), Vec3d{});
    for (const auto& [t, k] : corners) {
      const Index v = triangles_[t][k];
      for (const Vec3d& normal : records_[t].look.normals) {
        const double cosine = dot(normal, directions[v]);
        if (cosine < least[v]) least[v] = cosine, farthest[v] = normal;
      }
    }
    for (std::size_t v = 0; v < least.size(); ++v) directions[v] += (0.5 / round) * farthest[v];
    normalize_all();
  }
}

/// Lengths of fresh vertices by the sag of the triangles around.
void ShellCertifier::shape_shell() {
  point_steeply();
  const std::size_t vertices = mesh_->positions.size();
  held_.resize(vertices, 0);
  shell_.outer.resize(vertices);
  shell_.inner.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    if (fresh_[v] == 0) continue;
    shell_.outer[v] = shell_.inner[v] = kLeast * tolerance_;
    held_[v] = 0;
  }
  for (std::size_t t = 0; t < records_.size(); ++t) {
    const Look& look = records_[t].look;
    for (const Index v : triangles_[t]) {
      if (fresh_[v] == 0) continue;
      for (const auto& [sag, length] :
           {std::pair(look.outer, &shell_.outer[v]), std::pair(look.inner, &shell_.inner[v])}) {
        const double wanted = (1 + kRoom) * sag + kLeast * tolerance_;
        *length = std::max(*length, std::min(wanted, kMostAtFirst * tolerance_));
      }
    }
  }
  at_first_.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    if (fresh_[v] != 0) at_first_[v] = {shell_.outer[v], shell_.inner[v]};
  }
}

bool ShellCertifier::prove_signs() {
  const auto is_open = [this](std::uint32_t t) { return !records_[t].has_signs; };
  for (int change = 0;; ++change) {
    const bool looked = for_each_chunk(
        those(is_open), [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
          const std::vector<Finding> found =
              look_into(*surface_, *mesh_, shell_, chunk, Question::signs, counts);
          for (std::size_t i = 0; i < chunk.size(); ++i) {
            records_[chunk[i]].signs = found[i];
            records_[chunk[i]].has_signs = true;
          }
        });
    if (!looked) return false;
    if (change == kChanges || !adapt()) return true;
  }
}

/// Makes the shell thicker around triangles whose distance is in doubt, but thinner where it ends
/// in the next sheet, beyond a gap. False if nothing has changed.
bool ShellCertifier::adapt() {
  std::vector<char> thicker(shell_.direction.size(), 0), thinner = thicker;
  for (std::size_t t = 0; t < records_.size(); ++t) {
    const Look& look = records_[t].look;
    const Finding& signs = records_[t].signs;
    if (signs.doubt != Doubt::distance && signs.doubt != Doubt::crease) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = triangles_[t][k];
      // Where corners have the right sign, what is asked for is room for the bounds alone.
      const auto has_room = [&](const std::array<bool, 3>& wrong, double length, double at_first) {
        return wrong == std::array<bool, 3>{} && length > kMuchRoom * at_first;
      };
      const auto& [outer, inner] = at_first_[v];
      if (signs.outer && !has_room(signs.wrong_outer, shell_.outer[v], outer)) thicker[v] |= kOuter;
      if (signs.inner && !has_room(signs.wrong_inner, shell_.inner[v], inner)) thicker[v] |= kInner;
      // The surface was by far not that far over the corner itself.
      if (signs.wrong_outer[k] && look.height[k] < kNearer * shell_.outer[v]) thinner[v] |= kOuter;
      if (signs.wrong_inner[k] && -look.height[k] < kNearer * shell_.inner[v]) thinner[v] |= kInner;
    }
  }
  const double most = kWhole * tolerance_;
  std::vector<char> changed(thicker.size(), 0);
  bool any = false;
  for (std::size_t v = 0; v < changed.size(); ++v) {
    for (const auto& [side, length, at_first] :
         {std::tuple(kOuter, &shell_.outer[v], at_first_[v].first),
          std::tuple(kInner, &shell_.inner[v], at_first_[v].second)}) {
      const double before = *length;
      if ((thinner[v] & side) != 0) {
        *length = before > at_first ? at_first : kThinner * before;
        held_[v] |= side;
      } else if ((thicker[v] & side) != 0 && (held_[v] & side) == 0) {
        *length = std::max(before, std::min(kThicker * before, most));
      }
      if (*length != before) changed[v] = 1, any = true;
    }
  }
  for (std::size_t t = 0; any && t < records_.size(); ++t) {
    const auto& [a, b, c] = triangles_[t];
    if (changed[a] + changed[b] + changed[c] > 0) records_[t].forget_prism();
  }
  return any;
}

bool ShellCertifier::prove_growth(Question question, std::span<const std::uint32_t> triangles) {
  return for_each_chunk(triangles, [&](std::span<const std::uint32_t> chunk, ProverCounts& counts) {
    const std::vector<Finding> found =
        look_into(*surface_, *mesh_, shell_, chunk, question, counts);
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      Record& record = records_[chunk[i]];
      const bool layers = question == Question::layers;
      (layers ? record.layers : record.crossings) = found[i].doubt;
      (layers ? record.has_layers : record.has_crossings) = true;
    }
  });
}

/// The triangles whose layers may meet others, for all that their prisms tell. Those that are not
/// straight are in doubt; so are those around, as far as this goes.
std::vector<std::uint32_t> ShellCertifier::not_apart() {
  std::vector<char> crooked(shell_.direction.size(), 0);
  for (std::size_t t = 0; t < records_.size(); ++t) {
    const std::array<bool, 3> straight = leaves_directions_on_one_side(*mesh_, shell_, t);
    for (std::size_t k = 0; k < 3; ++k) {
      if (straight[k]) continue;
      crooked[triangles_[t][k]] = 1;
      if (records_[t].doubt == Doubt::none) records_[t].doubt = Doubt::fold;
    }
  }
  const std::vector<char> meets = prisms_that_meet(*mesh_, shell_);
  return those([&](std::uint32_t t) {
    const auto& [a, b, c] = triangles_[t];
    return meets[t] != 0 || crooked[a] + crooked[b] + crooked[c] > 0;
  });
}

}  // namespace cs2mesh
