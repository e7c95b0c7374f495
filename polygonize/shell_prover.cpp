#include "polygonize/shell_prover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "polygonize/bent_triangle.h"

namespace cs2mesh {
namespace {

/// Triangles are cut into quarters as often as this.
constexpr int kMostCuts = 4;
/// Pieces of one triangle that are looked at in one round; with more to do it counts as not proven.
constexpr std::size_t kMostPieces = 40;

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

/// A triangle or a part of one: the corners of its prism are those of the whole with weights.
struct Piece {
  std::size_t triangle = 0;  ///< its place in the list
  Corners weights{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  bool outer = true, inner = true, slope = true;  ///< not proven yet
  bool open() const { return outer || inner || slope; }
};

/// The part of the shell over a piece.
struct Prism {
  Corners outer, inner;
  HullBound bound;
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
         std::span<const std::uint32_t> triangles, ProverCounts& counts)
      : mesh_(mesh), shell_(shell), triangles_(triangles), counts_(counts) {
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
    doubts_.assign(triangles.size(), Doubt::none);
  }

  std::vector<Doubt> run() {
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      pieces.push_back({i});
      if (fans_[i].straight) continue;
      pieces.back().slope = false;
      doubts_[i] = Doubt::fold;
    }
    for (int cuts = 0; !pieces.empty(); ++cuts) {
      look_at(pieces);
      pieces = cuts < kMostCuts ? parts_of(pieces) : give_up_on(pieces);
    }
    return doubts_;
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
      prism.outer[k] = base + mixed(whole.out, piece.weights[k]);
      prism.inner[k] = base + mixed(whole.in, piece.weights[k]);
    }
    return prism;
  }

  HullBound bound_of(const Piece& piece, const Prism& prism) {
    std::array<Vec3d, 6> hull;
    std::copy(prism.outer.begin(), prism.outer.end(), hull.begin());
    std::copy(prism.inner.begin(), prism.inner.end(), hull.begin() + 3);
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
          if (!(jets[jet].value > 0)) doubts_[piece.triangle] = Doubt::distance;
          tangents[k] = {prism.inner[k], bound.low(jets[jet].value), bound.gradient(jets[jet])};
        }
        piece.inner = !(lowest_over(tangents, bound.bend) > 0);
      }
      if (piece.outer) {
        std::array<double, 3> high{};
        for (std::size_t k = 0; k < 3; ++k, ++value) {
          if (!(values[value] < 0)) doubts_[piece.triangle] = Doubt::distance;
          high[k] = bound.high(values[value]);
        }
        piece.outer = !(highest_over(prism.outer, high, bound.bend) < 0);
      }
    }
  }

  std::vector<Piece> parts_of(const std::vector<Piece>& pieces) {
    std::vector<std::size_t> count(triangles_.size(), 0);
    for (const Piece& piece : pieces) count[piece.triangle] += piece.open() ? 1 : 0;
    std::vector<Piece> parts, hopeless;
    for (const Piece& piece : pieces) {
      if (!piece.open() || doubts_[piece.triangle] == Doubt::distance) continue;
      if (count[piece.triangle] > kMostPieces) {
        hopeless.push_back(piece);
        continue;
      }
      for (std::size_t k = 0; k < 4; ++k) parts.push_back(quarter(piece, k));
    }
    give_up_on(hopeless);
    return parts;
  }

  std::vector<Piece> give_up_on(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) {
      if (!piece.open()) continue;
      Doubt& doubt = doubts_[piece.triangle];
      if (doubt == Doubt::distance) continue;
      const bool creased = !std::isfinite(bound_of(piece, prism_of(piece)).bend);
      if (piece.inner || piece.outer) {
        doubt = creased ? Doubt::crease : Doubt::distance;
      } else {
        doubt = creased ? Doubt::crease : Doubt::fold;
      }
    }
    return {};
  }

  const TriangleMesh& mesh_;
  const OffsetShell& shell_;
  std::span<const std::uint32_t> triangles_;
  ProverCounts& counts_;
  std::unique_ptr<ImplicitSurface> part_;
  std::vector<Whole> wholes_;
  std::vector<Fan> fans_;
  std::vector<Doubt> doubts_;
  std::vector<Prism> prisms_;  ///< of the pieces of a round
};

}  // namespace

std::vector<Doubt> doubts_of(const ImplicitSurface& surface, const TriangleMesh& mesh,
                             const OffsetShell& shell, std::span<const std::uint32_t> triangles,
                             ProverCounts& counts) {
  return Prover(surface, mesh, shell, triangles, counts).run();
}

}  // namespace cs2mesh
