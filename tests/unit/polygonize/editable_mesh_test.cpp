#include "polygonize/editable_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>

#include "libfield/base/random.h"
#include "polygonize/check.h"

namespace cs2mesh {
namespace {

TriangleMesh octahedron() {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

void expect_manifold(const EditableMesh& mesh) {
  const MeshReport report = check(mesh.mesh(), {.self_intersections = false});
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_TRUE(report.oriented);
  EXPECT_EQ(report.genus, 0);
  for (HalfEdge h = 0; h < 3 * mesh.mesh().triangles.size(); ++h) {
    EXPECT_EQ(start_of(mesh.mesh(), h), end_of(mesh.mesh(), mesh.opposite(h)));
    EXPECT_EQ(mesh.opposite(mesh.opposite(h)), h);
  }
}

TEST(EditableMesh, AFlipJoinsTheOtherCorners) {
  EditableMesh mesh(octahedron());
  const std::size_t triangles = mesh.mesh().triangles.size();
  ASSERT_TRUE(mesh.flip_edge(1));  // between 2 and 4, beside 0 and 1
  EXPECT_EQ(mesh.mesh().triangles.size(), triangles);
  expect_manifold(mesh);
  bool joined = false;
  for (HalfEdge h = 0; h < 3 * triangles; ++h) {
    joined = joined || (start_of(mesh.mesh(), h) == 0 && end_of(mesh.mesh(), h) == 1);
  }
  EXPECT_TRUE(joined);
  EXPECT_FALSE(mesh.flip_edge(0) && mesh.flip_edge(4)) << "some corner has three triangles left";
  expect_manifold(mesh);
}

TEST(EditableMesh, ATetrahedronCannotBeFlipped) {
  TriangleMesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EditableMesh mesh(tetrahedron);
  for (HalfEdge h = 0; h < 12; ++h) EXPECT_FALSE(mesh.flip_edge(h));
  EXPECT_EQ(mesh.mesh().triangles, tetrahedron.triangles);
}

TEST(EditableMesh, WhatWasPutIntoATriangleCanBeTakenOut) {
  EditableMesh mesh(octahedron());
  mesh.split_triangle(3, {0.2, 0.1, 0.3});
  const auto added = static_cast<EditableMesh::Index>(mesh.mesh().positions.size() - 1);
  HalfEdge from = 0;
  while (start_of(mesh.mesh(), from) != added) ++from;
  ASSERT_TRUE(mesh.can_collapse(from));
  mesh.collapse_edge(from);
  const TriangleMesh left = mesh.take();
  EXPECT_EQ(left.triangles.size(), octahedron().triangles.size());
  EXPECT_EQ(left.positions, octahedron().positions);
  expect_manifold(EditableMesh(left));
}

TEST(EditableMesh, AnySequenceOfCollapsesKeepsTheManifold) {
  Random random(8, 3);
  EditableMesh mesh(octahedron());
  int collapses = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto h = static_cast<HalfEdge>(random.bits() % (3 * mesh.mesh().triangles.size()));
    if (!mesh.alive(triangle_of(h))) continue;
    if (i % 3 == 0) {
      mesh.split_triangle(triangle_of(h), {random.uniform(), random.uniform(), random.uniform()});
    } else if (mesh.can_collapse(h)) {
      mesh.collapse_edge(h);
      ++collapses;
    }
  }
  EXPECT_GT(collapses, 50);
  expect_manifold(EditableMesh(mesh.take()));
}

TEST(EditableMesh, ClosingGapsKeepsTheOrderAndWhatIsJoined) {
  EditableMesh mesh(octahedron());
  for (std::size_t t = 0; t < 8; ++t) mesh.split_triangle(t, {0.1 * static_cast<double>(t), 1, 1});
  for (HalfEdge h = 0; h < 3 * mesh.mesh().triangles.size(); ++h) {
    if (mesh.alive(triangle_of(h)) && h % 5 == 0 && mesh.can_collapse(h)) mesh.collapse_edge(h);
  }
  const TriangleMesh before = mesh.mesh();
  std::size_t left = 0;
  for (std::size_t t = 0; t < before.triangles.size(); ++t) left += mesh.alive(t) ? 1 : 0;
  ASSERT_LT(left, before.triangles.size());
  const std::vector<EditableMesh::Index> former = mesh.close_gaps();
  ASSERT_EQ(mesh.mesh().triangles.size(), left);
  ASSERT_EQ(mesh.mesh().positions.size(), former.size());
  EXPECT_TRUE(std::is_sorted(former.begin(), former.end()));
  for (std::size_t v = 0; v < former.size(); ++v) {
    EXPECT_EQ(mesh.mesh().positions[v], before.positions[former[v]]);
  }
  expect_manifold(mesh);
  EXPECT_EQ(mesh.take().triangles.size(), left);
}

TEST(EditableMesh, ATetrahedronCannotBeCollapsed) {
  TriangleMesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const EditableMesh mesh(tetrahedron);
  for (HalfEdge h = 0; h < 12; ++h) EXPECT_FALSE(mesh.can_collapse(h));
}

TEST(EditableMesh, AnySequenceKeepsTheManifold) {
  Random random(7, 7);
  EditableMesh mesh(octahedron());
  int flips = 0;
  for (int i = 0; i < 300; ++i) {
    const auto h = static_cast<HalfEdge>(random.bits() % (3 * mesh.mesh().triangles.size()));
    const Vec3d p{random.uniform(), random.uniform(), random.uniform()};
    switch (random.bits() % 6) {
      case 0:
        mesh.split_triangle(triangle_of(h), p);
        break;
      case 1:
        mesh.split_edge(h, p);
        break;
      default:
        flips += mesh.flip_edge(h) ? 1 : 0;
    }
  }
  EXPECT_GT(flips, 100);
  expect_manifold(mesh);
}

}  // namespace
}  // namespace cs2mesh
