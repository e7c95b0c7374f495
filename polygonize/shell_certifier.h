// Which triangles of a mesh are proven to be the surface, by a shell around it (see certificate.h);
// what was found of triangles is kept while others are cut.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/certificate.h"
#include "polygonize/offset_shell.h"
#include "polygonize/shell_prover.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

class ShellCertifier {
 public:
  /// `surface` is to outlive this; tolerance in scene units, > 0.
  ShellCertifier(const ImplicitSurface& surface, double tolerance, Progress* progress)
      : surface_(&surface), tolerance_(tolerance), progress_(progress) {}

  /// Looks at the triangles of a mesh, and after the first one at those alone that are new and at
  /// their neighbours. Vertices keep their numbers and places, new ones come behind them. False if
  /// cancelled.
  bool run(const TriangleMesh& mesh);

  /// For each triangle of the last mesh `none`, `distance`, `fold`, `crease` or `profile`.
  std::vector<Doubt> doubts() const;
  /// Triangles that may help to prove what is in doubt for `distance` or `fold` if they are cut;
  /// sorted.
  std::vector<std::uint32_t> worth_cutting() const;
  /// Those among them for which parts that lie in them may do: that seem to be near, and to face
  /// the way the surface does, somewhere at least.
  std::vector<std::uint32_t> worth_cutting_flat() const;
  /// Of the surface at the vertices, outwards; of length one, or zero where there is none.
  std::vector<Vec3d> normals() const;
  /// Whether the surface seems to be within the tolerance of a triangle, by seven points.
  bool seems_near(std::size_t triangle) const;
  const OffsetShell& shell() const { return shell_; }
  const ProverCounts& counts() const { return counts_; }

 private:
  using Index = TriangleMesh::Index;

  /// What there is of a triangle: how far the surface seems to be outside and inside of it and of
  /// its corners, and unit normals, its own and those of the surface at some points.
  struct Look {
    double outer = 0.0, inner = 0.0;
    double width = 0.0;              ///< the longest side
    std::array<double, 3> height{};  ///< of the surface over the corners
    std::array<Vec3d, 8> normals;
  };

  /// What is known of a triangle, as long as its prism stays what it is.
  struct Record {
    Look look;
    Finding signs;
    bool has_look = false, has_signs = false;
    Doubt crossings = Doubt::none;
    bool has_crossings = false;
    Doubt layers = Doubt::none;
    bool has_layers = false;
    bool bent = false;          ///< in doubt as prisms are bent or may meet
    Doubt doubt = Doubt::none;  ///< in the end
    void forget_prism() { has_signs = has_crossings = has_layers = false; }
  };

  void take_over(const TriangleMesh& mesh);
  template <class F>
  bool for_each_chunk(std::span<const std::uint32_t> triangles, F&& f);
  /// The triangles, neighbours together, of which a predicate holds.
  template <class F>
  std::vector<std::uint32_t> those(F&& holds) const;
  bool look_around();
  void look_around(std::span<const std::uint32_t> chunk, ProverCounts& counts);
  void point_steeply();
  void shape_shell();
  bool prove_signs();
  bool adapt();
  bool prove_growth(Question question, std::span<const std::uint32_t> triangles);
  std::vector<std::uint32_t> not_apart();

  const ImplicitSurface* surface_;
  double tolerance_;
  Progress* progress_;
  const TriangleMesh* mesh_ = nullptr;           ///< during run() alone
  std::vector<std::array<Index, 3>> triangles_;  ///< of the last mesh
  std::vector<std::uint32_t> order_;             ///< neighbours in number near each other in space
  std::vector<Record> records_;
  std::vector<char> fresh_;  ///< by vertex: it has a triangle that is new
  OffsetShell shell_;
  std::vector<std::pair<double, double>> at_first_;  ///< outer and inner lengths of the shell
  std::vector<char> held_;  ///< by vertex: bits for sides that are to get no thicker
  ProverCounts counts_;
};

}  // namespace cs2mesh
