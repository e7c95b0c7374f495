#include "polygonize/leave_out.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "libfield/base/box_tree.h"
#include "polygonize/mesh_components.h"

namespace cs2mesh {
namespace {

/// A component of one of the parts.
struct Piece {
  std::size_t part = 0;
  MeshComponent component;
};

std::vector<Piece> pieces_of(const Model& model) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    for (MeshComponent& component : components(model.parts[i].mesh)) {
      pieces.push_back({i, std::move(component)});
    }
  }
  return pieces;
}

bool goes_round(const Model& model, const Piece& outer, const Piece& inner) {
  if (!outer.component.box.contains(inner.component.box)) return false;
  const TriangleMesh& mesh = model.parts[inner.part].mesh;
  const Vec3d& corner = mesh.positions[mesh.triangles[inner.component.triangles.front()][0]];
  return winding_number(model.parts[outer.part].mesh, outer.component, corner) > 0.5;
}

/// For each piece whether it lies inside of another.
std::vector<char> enclosed(const Model& model, const std::vector<Piece>& pieces,
                           const LeaveOutOptions& options) {
  std::vector<Aabb> boxes;
  boxes.reserve(pieces.size());
  for (const Piece& piece : pieces) boxes.push_back(piece.component.box);
  const BoxTree tree(std::move(boxes));
  std::vector<char> inside(pieces.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (cancelled(options.progress)) return;
    std::vector<std::uint32_t> around;
    tree.overlapping(pieces[i].component.box, around);
    inside[i] = std::any_of(around.begin(), around.end(), [&](std::uint32_t j) {
      if (j == i || (!options.across_parts && pieces[j].part != pieces[i].part)) return false;
      return goes_round(model, pieces[j], pieces[i]);
    });
  });
  return inside;
}

void count(LeftOut::Tally& tally, const MeshComponent& component) {
  ++tally.components;
  tally.voids += component.inwards ? 1 : 0;
  tally.area += component.area;
}

void keep(MeshPart& part, const std::vector<char>& kept) {
  if (std::find(kept.begin(), kept.end(), 0) == kept.end()) return;
  keep_triangles(part.mesh, kept);
  if (part.source_of.empty()) return;
  std::size_t next = 0;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (kept[t] != 0) part.source_of[next++] = part.source_of[t];
  }
  part.source_of.resize(next);
}

}  // namespace

LeftOut leave_out(Model& model, const LeaveOutOptions& options) {
  const std::vector<Piece> pieces = pieces_of(model);
  std::vector<char> inside(pieces.size());
  if (options.enclosed) inside = enclosed(model, pieces, options);
  if (cancelled(options.progress)) return {};

  LeftOut left_out;
  std::vector<std::vector<char>> kept;
  for (const MeshPart& part : model.parts) kept.emplace_back(part.mesh.triangles.size(), 1);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const MeshComponent& component = pieces[i].component;
    const bool small = component.box.diagonal() < options.smallest;
    if (!small && inside[i] == 0) continue;
    count(small ? left_out.small : left_out.enclosed, component);
    for (const TriangleMesh::Index t : component.triangles) kept[pieces[i].part][t] = 0;
  }
  for (std::size_t i = 0; i < model.parts.size(); ++i) keep(model.parts[i], kept[i]);
  return left_out;
}

}  // namespace cs2mesh
