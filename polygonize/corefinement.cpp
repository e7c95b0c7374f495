// CGAL's corefinement (Loriot, Rouxel-Labbé, Tournois and Yaz, "Polygon Mesh Processing", CGAL
// 5.5), with the tags of triangles carried along.
#include "polygonize/corefinement.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <exception>
#include <tuple>
#include <utility>

#include "polygonize/morton.h"

namespace cs2mesh {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tags = Mesh::Property_map<Mesh::Face_index, std::uint32_t>;
using Freshness = Mesh::Property_map<Mesh::Vertex_index, char>;

/// A mesh in CGAL's structure. Vertices are fresh until said otherwise.
struct Operand {
  Mesh mesh;
  Tags tags;
  Freshness is_fresh;
};

Tags tags_of(const Mesh& mesh) {
  return mesh.property_map<Mesh::Face_index, std::uint32_t>("f:tag").first;
}
Freshness freshness_of(const Mesh& mesh) {
  return mesh.property_map<Mesh::Vertex_index, char>("v:fresh").first;
}

/// False where the mesh is not manifold.
bool fill(Operand& operand, const TaggedMesh& from) {
  Mesh& mesh = operand.mesh;
  // The numbers of what is removed are not given to anything else, so that properties stay true.
  mesh.set_recycle_garbage(false);
  operand.tags = mesh.add_property_map<Mesh::Face_index, std::uint32_t>("f:tag", 0).first;
  operand.is_fresh = mesh.add_property_map<Mesh::Vertex_index, char>("v:fresh", 1).first;
  const auto count = static_cast<Mesh::size_type>(from.mesh.positions.size());
  const auto faces = static_cast<Mesh::size_type>(from.mesh.triangles.size());
  mesh.reserve(count, faces + faces / 2, faces);
  for (const Vec3d& p : from.mesh.positions) {
    operand.is_fresh[mesh.add_vertex({p.x, p.y, p.z})] = 0;
  }
  for (std::size_t t = 0; t < from.mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = from.mesh.triangles[t];
    const Mesh::Face_index face =
        mesh.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c));
    if (face == Mesh::null_face()) return false;
    operand.tags[face] = from.tags[t];
  }
  return CGAL::is_closed(mesh);
}

/// Hands tags on to the pieces that triangles are cut into, and to copies.
struct Bookkeeper : processing::Corefinement::Default_visitor<Mesh> {
  void before_subface_creations(Mesh::Face_index whole, Mesh& mesh) { tag = tags_of(mesh)[whole]; }
  void after_subface_created(Mesh::Face_index piece, Mesh& mesh) { tags_of(mesh)[piece] = tag; }
  void after_face_copy(Mesh::Face_index from, const Mesh& source, Mesh::Face_index to,
                       Mesh& target) {
    tags_of(target)[to] = tags_of(source)[from];
  }
  void after_vertex_copy(Mesh::Vertex_index from, const Mesh& source, Mesh::Vertex_index to,
                         Mesh& target) {
    freshness_of(target)[to] = freshness_of(source)[from];
  }
  std::uint32_t tag = 0;
};

/// The vertices along a space-filling curve: CGAL numbers them by addresses in memory here and
/// there, which differ from run to run.
std::vector<Mesh::Vertex_index> in_order(const Mesh& mesh) {
  const auto place = [&](Mesh::Vertex_index v) {
    const Kernel::Point_3& p = mesh.point(v);
    return Vec3d{p.x(), p.y(), p.z()};
  };
  Aabb all;
  for (const Mesh::Vertex_index v : mesh.vertices()) all.include(place(v));
  using Key = std::tuple<std::uint64_t, double, double, double>;
  std::vector<std::pair<Key, Mesh::Vertex_index>> keys;
  for (const Mesh::Vertex_index v : mesh.vertices()) {
    const Vec3d p = place(v);
    keys.push_back({{morton_code(all, p), p.x, p.y, p.z}, v});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Mesh::Vertex_index> order;
  order.reserve(keys.size());
  for (const auto& [key, v] : keys) order.push_back(v);
  return order;
}

void take_out(const Operand& operand, CorefinedUnion& out) {
  const Mesh& mesh = operand.mesh;
  std::vector<TriangleMesh::Index> number(mesh.num_vertices() + mesh.number_of_removed_vertices());
  for (const Mesh::Vertex_index v : in_order(mesh)) {
    number[v.idx()] = static_cast<TriangleMesh::Index>(out.mesh.mesh.positions.size());
    const Kernel::Point_3& p = mesh.point(v);
    out.mesh.mesh.positions.emplace_back(p.x(), p.y(), p.z());
    out.is_fresh.push_back(operand.is_fresh[v]);
  }
  std::vector<std::pair<std::array<TriangleMesh::Index, 3>, std::uint32_t>> faces;
  for (const Mesh::Face_index f : mesh.faces()) {
    const auto first = mesh.halfedge(f);
    const auto second = mesh.next(first);
    const auto corner = [&](Mesh::Halfedge_index h) { return number[mesh.source(h).idx()]; };
    std::array triangle{corner(first), corner(second), corner(mesh.next(second))};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
    faces.emplace_back(triangle, operand.tags[f]);
  }
  std::sort(faces.begin(), faces.end());
  for (const auto& [triangle, tag] : faces) {
    out.mesh.mesh.triangles.push_back(triangle);
    out.mesh.tags.push_back(tag);
  }
}

}  // namespace

bool has_corefinement() {
  return true;
}

CorefinedUnion corefined_union(const TaggedMesh& a, const TaggedMesh& b) {
  using Outcome = CorefinedUnion::Outcome;
  CorefinedUnion out;
  out.outcome = Outcome::broken_input;
  Operand first, second;
  if (!fill(first, a) || !fill(second, b)) return out;
  try {
    const bool manifold = processing::corefine_and_compute_union(
        first.mesh, second.mesh, first.mesh,
        processing::parameters::visitor(Bookkeeper()).throw_on_self_intersection(true));
    out.outcome = manifold ? Outcome::united : Outcome::not_manifold;
  } catch (const std::exception&) {  // self-intersections near the crease
    return out;
  }
  if (out.outcome == Outcome::united) take_out(first, out);
  return out;
}

}  // namespace cs2mesh
