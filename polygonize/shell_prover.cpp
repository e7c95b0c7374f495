#include "polygonize/shell_prover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "polygonize/bent_triangle.h"

namespace cs2mesh {
namespace {

/// Prisms are cut as often as this.
constexpr int kMostCuts = 4;
/// Pieces of one triangle that are looked at in one round; with more to do it counts as not proven.
constexpr std::size_t kMostPieces = 32;
/// Bounds asked for to show that one triangle's segments are crossed once.
constexpr int kMostTries = 200;

/// The directions along which F has to grow in a triangle's prism, inwards.
struct Fan {
  std::vector<Vec3d> directions;  ///< unit
  /// The prism is nowhere turned inside out: each segment leaves each layer on the same side.
  bool straight = false;
};

/// The normals (not unit) of the layers from a triangle with those two edges to one whose edges
/// differ by `d1` and `d2` lie between these, Bernstein's coefficients of a quadratic.
std::array<Vec3d, 3> layer_normals(const Vec3d& e1, const Vec3d& e2, const Vec3d& d1,
                                   const Vec3d& d2) {
  const Vec3d first = cross(e1, e2);
  return {first, first + 0.5 * (cross(e1, d2) + cross(d1, e2)), cross(e1 + d1, e2 + d2)};
}

/// A triangle's prism or a part of it: the corners are those of the whole with weights.
struct Piece {
  std::size_t triangle = 0;  ///< its place in the list
  Corners weights{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double low = 0.0, high = 1.0;  ///< from where to where it reaches, inner to outer triangle
  bool outer = true, inner = true, slope = true;  ///< not proven yet
  bool open() const { return outer || inner || slope; }
};

struct Prism {
  Corners outer, inner;
  HullBound bound;

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

/// The quarter of a piece at a corner, or with 3 that in the middle.
Piece quarter(const Piece& piece, std::size_t which) {
  Corners middle;
  for (std::size_t i = 0; i < 3; ++i) {
    middle[i] = 0.5 * (piece.weights[(i + 1) % 3] + piece.weights[(i + 2) % 3]);
  }
  Piece part = piece;
  if (which == 3) {
    part.weights = middle;
  } else {
    part.weights[(which + 1) % 3] = middle[(which + 2) % 3];
    part.weights[(which + 2) % 3] = middle[(which + 1) % 3];
  }
  return part;
}

/// Looks at triangles in rounds: all pieces of a round are evaluated together.
class Prover {
 public:
  Prover(const ImplicitSurface& surface, const TriangleMesh& mesh, const OffsetShell& shell,
         std::span<const std::uint32_t> triangles, Question question, ProverCounts& counts)
      : mesh_(mesh),
        shell_(shell),
        triangles_(triangles),
        slopes_(question == Question::slopes),
        counts_(counts) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      wholes_.push_back(whole_prism(i));
      fans_.push_back(fan_of(i));
    }
    Aabb box;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Prism prism = prism_of({i});
      for (const Vec3d& p : prism.outer) box.include(p);
      for (const Vec3d& p : prism.inner) box.include(p);
    }
    part_ = surface.restrict_to(box);
    findings_.assign(triangles.size(), {});
  }

  std::vector<Finding> run() {
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (slopes_ && !fans_[i].straight) {
        findings_[i].doubt = Doubt::fold;
        continue;
      }
      pieces.push_back({i});
      pieces.back().outer = pieces.back().inner = !slopes_;
      pieces.back().slope = slopes_;
    }
    for (int cuts = 0; !pieces.empty(); ++cuts) {
      look_at(pieces);
      pieces = cuts < kMostCuts ? parts_of(pieces) : give_up_on(pieces);
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      int tries = kMostTries;
      findings_[i].rises =
          findings_[i].doubt == Doubt::fold && fans_[i].straight && rises_in({i}, tries);
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

  Fan fan_of(std::size_t i) const {
    const Whole& w = wholes_[i];
    const auto& corners = mesh_.triangles[triangles_[i]];
    const Vec3d e1 = w.base[1] - w.base[0], e2 = w.base[2] - w.base[0];
    Fan fan;
    fan.straight = true;
    for (const TriangleMesh::Index v : corners) fan.directions.push_back(-shell_.direction[v]);
    for (const Corners& way : {w.out, w.in}) {
      for (const Vec3d& normal : layer_normals(e1, e2, way[1] - way[0], way[2] - way[0])) {
        for (const TriangleMesh::Index v : corners) {
          fan.straight = fan.straight && dot(normal, shell_.direction[v]) > 0;
        }
        if (fan.straight) fan.directions.push_back(-normalized(normal));
      }
    }
    return fan;
  }

  Prism prism_of(const Piece& piece) const {
    const Whole& whole = wholes_[piece.triangle];
    Prism prism;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d base = mixed(whole.base, piece.weights[k]);
      const Vec3d outer = base + mixed(whole.out, piece.weights[k]);
      const Vec3d inner = base + mixed(whole.in, piece.weights[k]);
      prism.outer[k] = piece.high == 1 ? outer : inner + piece.high * (outer - inner);
      prism.inner[k] = piece.low == 0 ? inner : inner + piece.low * (outer - inner);
    }
    return prism;
  }

  /// Of the whole prism for a slope, for a sign of the layer alone.
  HullBound bound_of(const Piece& piece, const Prism& prism) {
    std::vector<Vec3d> hull;
    if (piece.outer || piece.slope) hull.assign(prism.outer.begin(), prism.outer.end());
    if (piece.inner || piece.slope) hull.insert(hull.end(), prism.inner.begin(), prism.inner.end());
    ++counts_.bounds;
    const std::span<const Vec3d> directions = fans_[piece.triangle].directions;
    return part_->hull_bound(hull, piece.slope ? directions : directions.first(0));
  }

  void look_at(std::vector<Piece>& pieces) {
    prisms_.clear();
    std::vector<Vec3d> inner, outer;
    for (Piece& piece : pieces) {
      prisms_.push_back(prism_of(piece));
      Prism& prism = prisms_.back();
      prism.bound = bound_of(piece, prism);
      if (prism.bound.slope > 0) piece.slope = false;
      if (piece.inner) inner.insert(inner.end(), prism.inner.begin(), prism.inner.end());
      if (piece.outer) outer.insert(outer.end(), prism.outer.begin(), prism.outer.end());
    }
    look_at_signs(pieces, jets_at(inner), values_at(outer));
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
  void look_at_signs(std::vector<Piece>& pieces, std::span<const Jet> jets,
                     std::span<const double> values) {
    std::size_t jet = 0, value = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      Piece& piece = pieces[i];
      const Prism& prism = prisms_[i];
      const HullBound& bound = prism.bound;
      if (piece.inner) {
        std::array<Tangent, 3> tangents;
        for (std::size_t k = 0; k < 3; ++k, ++jet) {
          if (!(jets[jet].value > 0)) too_far(piece.triangle).inner = true;
          tangents[k] = {prism.inner[k], bound.low(jets[jet].value), bound.gradient(jets[jet])};
        }
        piece.inner = !(lowest_over(tangents, bound.bend) > 0);
      }
      if (piece.outer) {
        std::array<double, 3> high{};
        for (std::size_t k = 0; k < 3; ++k, ++value) {
          if (!(values[value] < 0)) too_far(piece.triangle).outer = true;
          high[k] = bound.high(values[value]);
        }
        piece.outer = !(highest_over(prism.outer, high, bound.bend) < 0);
      }
    }
  }

  /// Whether F grows inwards along all segments of the piece wherever it may vanish.
  bool rises_in(const Piece& piece, int& tries) {
    if (--tries < 0) return false;
    const Prism prism = prism_of(piece);
    std::array<Vec3d, 6> hull;
    std::copy(prism.outer.begin(), prism.outer.end(), hull.begin());
    std::copy(prism.inner.begin(), prism.inner.end(), hull.begin() + 3);
    ++counts_.bounds;
    const HullBound bound =
        part_->hull_bound(hull, std::span(fans_[piece.triangle].directions).first(3));
    if (bound.slope > 0 || keeps_sign(hull, bound)) return true;
    Piece whole = piece;
    whole.outer = whole.inner = false;
    std::vector<Piece> parts;
    cut(whole, prism, parts);
    return std::all_of(parts.begin(), parts.end(),
                       [&](const Piece& part) { return rises_in(part, tries); });
  }

  bool keeps_sign(const std::array<Vec3d, 6>& hull, const HullBound& bound) {
    Vec3d center{};
    for (const Vec3d& p : hull) center += p / 6.0;
    const std::vector<Jet> jet = jets_at({&center, 1});
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

  Finding& too_far(std::size_t triangle) {
    findings_[triangle].doubt = Doubt::distance;
    return findings_[triangle];
  }

  std::vector<Piece> parts_of(const std::vector<Piece>& pieces) {
    std::vector<std::size_t> count(triangles_.size(), 0);
    for (const Piece& piece : pieces) count[piece.triangle] += piece.open() ? 1 : 0;
    std::vector<Piece> parts, hopeless;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Piece& piece = pieces[i];
      if (!piece.open() || findings_[piece.triangle].doubt == Doubt::distance) continue;
      if (count[piece.triangle] > kMostPieces) {
        hopeless.push_back(piece);
      } else {
        cut(piece, prisms_[i], parts);
      }
    }
    give_up_on(hopeless);
    return parts;
  }

  /// Signs are a matter of the layers; slopes of the prism, which may be thicker than wide.
  static void cut(const Piece& piece, const Prism& prism, std::vector<Piece>& parts) {
    Piece signs = piece, slope = piece;
    signs.slope = slope.outer = slope.inner = false;
    const bool in_halves = piece.slope && prism.thick();
    if (in_halves) {
      const double middle = 0.5 * (piece.low + piece.high);
      slope.high = middle;
      parts.push_back(slope);
      slope.low = middle, slope.high = piece.high;
      parts.push_back(slope);
    }
    const Piece& rest = in_halves ? signs : piece;
    for (std::size_t k = 0; k < 4 && rest.open(); ++k) parts.push_back(quarter(rest, k));
  }

  std::vector<Piece> give_up_on(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) {
      Finding& finding = findings_[piece.triangle];
      if (!piece.open() || finding.doubt == Doubt::distance) continue;
      if (!std::isfinite(bound_of(piece, prism_of(piece)).bend)) {
        finding.doubt = Doubt::crease;
      } else if (piece.inner || piece.outer) {
        finding = {Doubt::distance, piece.outer, piece.inner};
      } else if (finding.doubt == Doubt::none) {
        finding.doubt = Doubt::fold;
      }
    }
    return {};
  }

  const TriangleMesh& mesh_;
  const OffsetShell& shell_;
  std::span<const std::uint32_t> triangles_;
  bool slopes_ = false;
  ProverCounts& counts_;
  std::unique_ptr<ImplicitSurface> part_;
  std::vector<Whole> wholes_;
  std::vector<Fan> fans_;
  std::vector<Finding> findings_;
  std::vector<Prism> prisms_;  ///< of the pieces of a round
};

}  // namespace

std::array<Vec3d, 6> prism_corners(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle) {
  std::array<Vec3d, 6> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const TriangleMesh::Index v = mesh.triangles[triangle][k];
    corners[k] = mesh.positions[v] + shell.outer[v] * shell.direction[v];
    corners[k + 3] = mesh.positions[v] - shell.inner[v] * shell.direction[v];
  }
  return corners;
}

bool are_apart(const std::array<Vec3d, 6>& a, const std::array<Vec3d, 6>& b) {
  const auto apart_along = [&](const Vec3d& axis) {
    double low[2], high[2];
    for (std::size_t s = 0; s < 2; ++s) {
      const auto& corners = s == 0 ? a : b;
      low[s] = high[s] = dot(corners[0], axis);
      for (const Vec3d& p : corners) {
        low[s] = std::min(low[s], dot(p, axis));
        high[s] = std::max(high[s], dot(p, axis));
      }
    }
    const double size = std::abs(low[0]) + std::abs(high[0]) + std::abs(low[1]) + std::abs(high[1]);
    return low[1] - high[0] > 1e-14 * size || low[0] - high[1] > 1e-14 * size;
  };
  const auto separated_by_faces_of = [&](const std::array<Vec3d, 6>& p) {
    for (const std::size_t k : {0U, 3U}) {
      if (apart_along(cross(p[k + 1] - p[k], p[k + 2] - p[k]))) return true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (apart_along(cross(p[next] - p[k], p[k + 3] - p[k])) ||
          apart_along(cross(p[next + 3] - p[k + 3], p[next + 3] - p[next]))) {
        return true;
      }
    }
    return false;
  };
  if (separated_by_faces_of(a) || separated_by_faces_of(b)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (apart_along(cross(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]))) return true;
    }
  }
  return false;
}

std::vector<Finding> look_into(const ImplicitSurface& surface, const TriangleMesh& mesh,
                               const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                               Question question, ProverCounts& counts) {
  return Prover(surface, mesh, shell, triangles, question, counts).run();
}

}  // namespace cs2mesh
