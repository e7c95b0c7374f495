#include "polygonize/mend_folds.h"

#include "libfield/base/check.h"
#include "polygonize/fold.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

class FoldMender {
 public:
  FoldMender(EditableMesh& mesh, std::span<const Vec3d> normals, double least)
      : mesh_(mesh), normals_(normals), least_(least) {}

  FoldsMended run() {
    constexpr int kMostSweeps = 6;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      std::size_t mended = 0;
      for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) {
        if (mesh_.alive(t) && folded(t) && mend(t)) ++mended;
      }
      if (mended == 0) break;
    }
    return done_;
  }

 private:
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  bool faces_outward(Index a, Index b, Index c) const {
    return faces_normals(mesh_.mesh().positions, normals_, {a, b, c}, least_);
  }

  bool folded(std::size_t triangle) const {
    const auto& t = mesh_.mesh().triangles[triangle];
    return !faces_outward(t[0], t[1], t[2]);
  }

  bool mend(std::size_t triangle) {
    HalfEdge best = 0;
    int most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      for (const HalfEdge way : {h, mesh_.opposite(h)}) {
        const int gain = folds_unmade(way);
        if (gain > most && mesh_.can_collapse(way)) {
          most = gain;
          best = way;
        }
      }
    }
    if (most > 0) {
      mesh_.collapse_edge(best);
      ++done_.collapses;
      return true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      const HalfEdge back = mesh_.opposite(h);
      const Index a = start(h), b = end(h);
      const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
      if (c != d && faces_outward(d, c, a) && faces_outward(c, d, b) && mesh_.flip_edge(h)) {
        ++done_.flips;
        return true;
      }
    }
    return false;
  }

  /// How many folded triangles a collapse would leave fewer.
  int folds_unmade(HalfEdge h) const {
    const Index b = end(h);
    const HalfEdge back = mesh_.opposite(h);
    int before = 0, after = 0;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      const Index c = end(turn), d = end(next_in_triangle(turn));
      if (folded(triangle_of(turn))) ++before;
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      if (!faces_outward(b, c, d)) ++after;
    });
    return before - after;
  }

  EditableMesh& mesh_;
  std::span<const Vec3d> normals_;
  double least_;
  FoldsMended done_;
};

}  // namespace

FoldsMended mend_folds(EditableMesh& mesh, std::span<const Vec3d> normals, double least) {
  require(normals.size() == mesh.mesh().positions.size(), "mend_folds: one normal a vertex");
  return FoldMender(mesh, normals, least).run();
}

}  // namespace cs2mesh
