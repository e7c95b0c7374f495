#include "polygonize/shell_prover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "polygonize/bent_triangle.h"

namespace cs2mesh {
namespace {

/// Triangles are cut as often as this to find the signs of their layers.
constexpr int kMostCuts = 4;
/// Pieces of one triangle that are looked at in one round; with more to do it counts as not proven.
constexpr std::size_t kMostPieces = 32;
/// Pieces of a prism that are looked at to show that F grows in it.
constexpr int kMostTries = 60;

/// F at the corners of a piece's layers, as far as their signs are open.
struct Seen {
  std::array<Jet, 3> inner{};
  std::array<double, 3> outer{};
};

/// A triangle's prism or a part of it: the corners are those of the whole with weights.
struct Piece {
  std::size_t triangle = 0;  ///< its place in the list
  Corners weights{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double low = 0.0, high = 1.0;     ///< from where to where it reaches, inner to outer triangle
  bool outer = true, inner = true;  ///< the layers whose sign is not proven yet
  int cuts = 0;                     ///< how often it was cut
  HullBound bound{};                ///< of the signs, of it or of what it is a part of
  Seen seen{};                      ///< at its corners
  bool open() const { return outer || inner; }
};

struct Prism {
  Corners outer, inner;

  std::array<Vec3d, 6> corners() const {
    return {outer[0], outer[1], outer[2], inner[0], inner[1], inner[2]};
  }
  bool thick() const {
    double height = 0.0, side = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      height = std::max(height, squared_norm(outer[i] - inner[i]));
      side = std::max(side, squared_norm(outer[i] - outer[(i + 1) % 3]));
    }
    return height > side;
  }
};

Vec3d mixed(const Corners& corners, const Vec3d& weights) {
  return weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2];
}

/// Between two corners of a piece each, opposite to the third.
Corners middles_of(const Piece& piece) {
  Corners middle;
  for (std::size_t i = 0; i < 3; ++i) {
    middle[i] = 0.5 * (piece.weights[(i + 1) % 3] + piece.weights[(i + 2) % 3]);
  }
  return middle;
}

/// What three corners hold for the quarter of a triangle at a corner, or with 3 for that in the
/// middle; `middle` is opposite to the corners.
template <class T>
std::array<T, 3> quarter(const std::array<T, 3>& corner, const std::array<T, 3>& middle,
                         std::size_t which) {
  if (which == 3) return middle;
  std::array<T, 3> part = corner;
  part[(which + 1) % 3] = middle[(which + 2) % 3];
  part[(which + 2) % 3] = middle[(which + 1) % 3];
  return part;
}

/// The quarters of a piece, in whose middles F is as was seen.
std::array<Piece, 4> quarters(const Piece& piece, const Seen& middle = {}) {
  std::array<Piece, 4> parts{piece, piece, piece, piece};
  const Corners weights = middles_of(piece);
  for (std::size_t k = 0; k < 4; ++k) {
    ++parts[k].cuts;
    parts[k].weights = quarter(piece.weights, weights, k);
    parts[k].seen.inner = quarter(piece.seen.inner, middle.inner, k);
    parts[k].seen.outer = quarter(piece.seen.outer, middle.outer, k);
  }
  return parts;
}

/// Looks at neighbouring triangles by a restriction of the surface.
class Prover {
 public:
  Prover(const ImplicitSurface& surface, const TriangleMesh& mesh, const OffsetShell& shell,
         std::span<const std::uint32_t> triangles, ProverCounts& counts)
      : mesh_(mesh), shell_(shell), triangles_(triangles), counts_(counts) {
    Aabb box;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      wholes_.push_back(whole_prism(i));
      for (const Vec3d& p : prism_of({i}).corners()) box.include(p);
    }
    part_ = surface.restrict_to(box);
    findings_.assign(triangles.size(), {});
  }

  /// In rounds: all pieces of a round are evaluated together.
  std::vector<Finding> signs() {
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < triangles_.size(); ++i) pieces.push_back({i});
    const std::vector<Seen> seen =
        seen_of(pieces, [](const Piece& piece) -> const Corners& { return piece.weights; });
    for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].seen = seen[i];
    for (int cuts = 0; !pieces.empty(); ++cuts) {
      for (Piece& piece : pieces) look_at(piece);
      if (cuts == kMostCuts) {
        give_up_on(pieces);
        break;
      }
      pieces = parts_of(pieces);
    }
    return findings_;
  }

  std::vector<Finding> growth(Question question) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      int tries = kMostTries;
      if (grows_in({i}, question, tries)) continue;
      findings_[i].doubt = doubt_of({i}, Doubt::fold);
    }
    return findings_;
  }

 private:
  /// The corners of a triangle, and the ways from there to the outer and the inner triangle.
  struct Whole {
    Corners base, out, in;
  };

  Whole whole_prism(std::size_t i) const {
    Whole whole;
    for (std::size_t k = 0; k < 3; ++k) {
      const TriangleMesh::Index v = mesh_.triangles[triangles_[i]][k];
      whole.base[k] = mesh_.positions[v];
      whole.out[k] = shell_.outer[v] * shell_.direction[v];
      whole.in[k] = -shell_.inner[v] * shell_.direction[v];
    }
    return whole;
  }

  /// The point of the whole with those weights, so high above the inner triangle.
  static Vec3d place(const Whole& whole, const Vec3d& weights, double height) {
    const Vec3d base = mixed(whole.base, weights);
    if (height == 1) return base + mixed(whole.out, weights);
    const Vec3d inner = base + mixed(whole.in, weights);
    return height == 0 ? inner : inner + height * (base + mixed(whole.out, weights) - inner);
  }

  Prism prism_of(const Piece& piece) const {
    const Whole& whole = wholes_[piece.triangle];
    Prism prism;
    for (std::size_t k = 0; k < 3; ++k) {
      prism.outer[k] = place(whole, piece.weights[k], piece.high);
      prism.inner[k] = place(whole, piece.weights[k], piece.low);
    }
    return prism;
  }

  /// Inwards along the segments of a piece, and where that is asked for the normals of the layers
  /// of its prism. Between those at its corners lie the directions of all segments of the piece:
  /// these are sums of the ways at its corners.
  std::vector<Vec3d> directions_of(const Piece& piece, Question question) const {
    const Whole& whole = wholes_[piece.triangle];
    std::vector<Vec3d> directions;
    for (const Vec3d& weights : piece.weights) {
      directions.push_back(normalized(mixed(whole.in, weights) - mixed(whole.out, weights)));
    }
    if (question == Question::layers) {
      for (const Vec3d& normal : layer_normals(mesh_, shell_, triangles_[piece.triangle])) {
        directions.push_back(-normalized(normal));
      }
    }
    return directions;
  }

  // ---- Signs ----

  /// Of the layers whose sign is open.
  HullBound bound_of(const Piece& piece, const Prism& prism,
                     std::span<const Vec3d> directions = {}) {
    std::vector<Vec3d> hull;
    if (piece.outer) hull.assign(prism.outer.begin(), prism.outer.end());
    if (piece.inner) hull.insert(hull.end(), prism.inner.begin(), prism.inner.end());
    ++counts_.bounds;
    return part_->hull_bound(hull, directions);
  }

  /// F in three places of the open layers of each piece, whose weights are asked for.
  template <class F>
  std::vector<Seen> seen_of(const std::vector<Piece>& pieces, const F& weights_of) {
    std::vector<Vec3d> inner, outer;
    for (const Piece& piece : pieces) {
      for (const Vec3d& weights : weights_of(piece)) {
        if (piece.inner) inner.push_back(place(wholes_[piece.triangle], weights, 0.0));
        if (piece.outer) outer.push_back(place(wholes_[piece.triangle], weights, 1.0));
      }
    }
    const std::vector<Jet> jets = jets_at(inner);
    const std::vector<double> values = values_at(outer);
    std::vector<Seen> seen(pieces.size());
    std::size_t jet = 0, value = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (pieces[i].inner) seen[i].inner[k] = jets[jet++];
        if (pieces[i].outer) seen[i].outer[k] = values[value++];
      }
    }
    return seen;
  }

  std::vector<Jet> jets_at(std::span<const Vec3d> points) {
    std::vector<Jet> jets(points.size());
    part_->jets(points, jets);
    counts_.values += points.size();
    counts_.gradients += points.size();
    return jets;
  }
  std::vector<double> values_at(std::span<const Vec3d> points) {
    std::vector<double> values(points.size());
    part_->values(points, values);
    counts_.values += points.size();
    return values;
  }

  /// Where F is of the wrong sign at a corner of a layer, no cutting helps.
  void look_at(Piece& piece) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (piece.inner && !(piece.seen.inner[k].value > 0)) wrong(piece, k, false);
      if (piece.outer && !(piece.seen.outer[k] < 0)) wrong(piece, k, true);
    }
    if (findings_[piece.triangle].doubt != Doubt::distance) settle(piece, prism_of(piece));
  }

  /// What bounds a piece bounds its parts, too. A bound of a part's own is asked for where that of
  /// the whole would not do for parts of it either: those have a quarter of the bend.
  void settle(Piece& piece, const Prism& prism) {
    const Seen& seen = piece.seen;
    if (piece.cuts > 0 && std::isfinite(piece.bound.bend)) {
      close_layers(piece, prism);
      const bool parts_may_do = (!piece.outer || is_outside(prism, seen, piece.bound, 0.25)) &&
                                (!piece.inner || is_inside(prism, seen, piece.bound, 0.25));
      if (parts_may_do) return;
      piece.bound = bound_of(piece, prism);
    } else if (piece.cuts > 0) {
      piece.bound = bound_of(piece, prism);
    } else {
      // Between its layers lies the whole prism.
      piece.bound = bound_of(piece, prism, directions_of(piece, Question::crossings));
      findings_[piece.triangle].grows = piece.bound.slope > 0;
    }
    close_layers(piece, prism);
    if (!std::isfinite(piece.bound.bend)) close_kinked_layers(piece, prism);
  }

  /// Where F has kinks, by its slopes.
  void close_kinked_layers(Piece& piece, const Prism& prism) {
    const Seen& seen = piece.seen;
    HullBound plain;
    plain.error = piece.bound.error;
    std::array<double, 3> at{};
    if (piece.outer) {
      for (std::size_t k = 0; k < 3; ++k) at[k] = plain.high(seen.outer[k]);
      piece.outer = !(highest_over(prism.outer, at, slopes_over(prism.outer)) < 0);
    }
    if (piece.inner) {
      for (std::size_t k = 0; k < 3; ++k) at[k] = plain.low(seen.inner[k].value);
      piece.inner = !(lowest_over(prism.inner, at, slopes_over(prism.inner)) > 0);
    }
  }

  std::array<Interval, 3> slopes_over(std::span<const Vec3d> points) {
    Aabb box;
    for (const Vec3d& p : points) box.include(p);
    ++counts_.bounds;
    return part_->enclose_gradient(box);
  }

  static void close_layers(Piece& piece, const Prism& prism) {
    const Seen& seen = piece.seen;
    piece.outer = piece.outer && !is_outside(prism, seen, piece.bound, 1.0);
    piece.inner = piece.inner && !is_inside(prism, seen, piece.bound, 1.0);
  }

  /// Whether the outer triangle is outside, if F bends by no more than that part of the bound.
  static bool is_outside(const Prism& prism, const Seen& seen, const HullBound& bound,
                         double part) {
    std::array<double, 3> high{};
    for (std::size_t k = 0; k < 3; ++k) high[k] = bound.high(seen.outer[k]);
    return highest_over(prism.outer, high, part * bound.bend) < 0;
  }
  /// And the inner one inside.
  static bool is_inside(const Prism& prism, const Seen& seen, const HullBound& bound, double part) {
    std::array<Tangent, 3> tangents;
    for (std::size_t k = 0; k < 3; ++k) {
      tangents[k] = {prism.inner[k], bound.low(seen.inner[k].value), bound.gradient(seen.inner[k])};
    }
    return lowest_over(tangents, part * bound.bend) > 0;
  }

  void wrong(const Piece& piece, std::size_t corner, bool outer) {
    Finding& finding = findings_[piece.triangle];
    finding.doubt = Doubt::distance;
    (outer ? finding.outer : finding.inner) = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (piece.weights[corner][k] == 1)
        (outer ? finding.wrong_outer : finding.wrong_inner)[k] = true;
    }
  }

  std::vector<Piece> parts_of(const std::vector<Piece>& pieces) {
    std::vector<std::size_t> count(triangles_.size(), 0);
    for (const Piece& piece : pieces) count[piece.triangle] += piece.open() ? 1 : 0;
    std::vector<Piece> open, parts, hopeless;
    for (const Piece& piece : pieces) {
      if (!piece.open() || findings_[piece.triangle].doubt == Doubt::distance) continue;
      (count[piece.triangle] > kMostPieces ? hopeless : open).push_back(piece);
    }
    const std::vector<Seen> middles = seen_of(open, middles_of);
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (const Piece& part : quarters(open[i], middles[i])) parts.push_back(part);
    }
    give_up_on(hopeless);
    return parts;
  }

  /// What is in the way of bounds, if anything is, else `usual`.
  Doubt doubt_of(const Piece& piece, Doubt usual) {
    const Prism prism = prism_of(piece);
    if (std::isfinite(bound_of(piece, prism).bend)) return usual;
    Aabb box;
    for (const Vec3d& p : prism.corners()) box.include(p);
    return std::isfinite(part_->derivative_bound(1, box)) ? Doubt::crease : Doubt::profile;
  }

  void give_up_on(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) {
      Finding& finding = findings_[piece.triangle];
      if (!piece.open() || finding.doubt == Doubt::distance) continue;
      finding.doubt = doubt_of(piece, Doubt::distance);
      finding.outer = piece.outer;
      finding.inner = piece.inner;
    }
  }

  // ---- Growth ----

  bool grows_in(const Piece& piece, Question question, int& tries) {
    if (--tries < 0) return false;
    const Prism prism = prism_of(piece);
    const std::vector<Vec3d> directions = directions_of(piece, question);
    const std::array<Vec3d, 6> hull = prism.corners();
    ++counts_.bounds;
    const HullBound bound = part_->hull_bound(hull, directions);
    if (bound.slope > 0) return true;
    if (question == Question::crossings) {
      if (keeps_sign(hull, bound) || grows_where_it_vanishes(hull, directions)) return true;
    }
    if (!std::isfinite(bound.bend) && !std::isfinite(bound.slope)) return false;
    const std::vector<Piece> parts = parts_of(piece, prism);
    return std::all_of(parts.begin(), parts.end(),
                       [&](const Piece& part) { return grows_in(part, question, tries); });
  }

  bool grows_where_it_vanishes(const std::array<Vec3d, 6>& hull,
                               std::span<const Vec3d> directions) const {
    Aabb box;
    for (const Vec3d& p : hull) box.include(p);
    return std::all_of(directions.begin(), directions.end(),
                       [&](const Vec3d& d) { return part_->least_slope(box, d) > 0; });
  }

  bool keeps_sign(const std::array<Vec3d, 6>& hull, const HullBound& bound) {
    Vec3d center{};
    for (const Vec3d& p : hull) center += p / 6.0;
    const std::vector<Jet> jet = jets_at({&center, 1});
    if (!std::isfinite(bound.bend)) return keeps_sign_by_slopes(hull, bound, center, jet[0].value);
    const Tangent tangent{center, bound.low(jet[0].value), bound.gradient(jet[0])};
    double low = HullBound::kInfinity, high = -HullBound::kInfinity, squared = 0.0;
    for (const Vec3d& p : hull) {
      low = std::min(low, tangent.lowest_at(p, bound.bend));
      squared = std::max(squared, squared_norm(p - center));
    }
    if (low > 0) return true;
    if (jet[0].value > 0) return false;
    for (const double value : values_at(hull)) high = std::max(high, bound.high(value));
    return high + 0.5 * bound.bend * squared * (1 + 1e-12) < 0;
  }

  bool keeps_sign_by_slopes(const std::array<Vec3d, 6>& hull, const HullBound& bound,
                            const Vec3d& center, double value) {
    HullBound plain;
    plain.error = bound.error;
    const std::array<Interval, 3> slopes = slopes_over(hull);
    Interval range(plain.low(value), plain.high(value));
    Interval change(0.0);
    for (const Vec3d& p : hull) change = cs2mesh::hull(change, change_between(center, p, slopes));
    range = range + change;
    return range.lo > 0 || range.hi < 0;
  }

  /// Halves of what is thicker than wide, else quarters.
  static std::vector<Piece> parts_of(const Piece& piece, const Prism& prism) {
    std::vector<Piece> parts;
    if (prism.thick()) {
      parts.assign(2, piece);
      parts[0].high = parts[1].low = 0.5 * (piece.low + piece.high);
    } else {
      for (const Piece& part : quarters(piece)) parts.push_back(part);
    }
    return parts;
  }

  const TriangleMesh& mesh_;
  const OffsetShell& shell_;
  std::span<const std::uint32_t> triangles_;
  ProverCounts& counts_;
  std::unique_ptr<ImplicitSurface> part_;
  std::vector<Whole> wholes_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> look_into(const ImplicitSurface& surface, const TriangleMesh& mesh,
                               const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                               Question question, ProverCounts& counts) {
  Prover prover(surface, mesh, shell, triangles, counts);
  return question == Question::signs ? prover.signs() : prover.growth(question);
}

}  // namespace cs2mesh
