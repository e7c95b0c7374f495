#include "polygonize/obj.h"

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;

TEST(Obj, RoundTripIsExact) {
  const Folder folder;
  const Model model = two_spheres();
  ASSERT_TRUE(write_mesh(model, folder / "a.obj"));
  const Result<Model> read = read_mesh(folder / "a.obj");
  ASSERT_TRUE(read);
  ASSERT_EQ(read->parts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const TriangleMesh& in = model.parts[i].mesh;
    const TriangleMesh& out = read->parts[i].mesh;
    EXPECT_EQ(read->parts[i].name, model.parts[i].name);
    EXPECT_EQ(out.positions, in.positions);
    EXPECT_EQ(out.triangles, in.triangles);
    EXPECT_EQ(out.normals, in.normals);
    ASSERT_EQ(out.colors.size(), in.colors.size());
    for (std::size_t k = 0; k < in.colors.size(); ++k) {
      EXPECT_NEAR(norm(Vec3d(out.colors[k]) - Vec3d(in.colors[k])), 0, 1e-6);
    }
  }
}

TEST(Obj, MaterialLibraryLiesBesideIt) {
  const Folder folder;
  ASSERT_TRUE(write_mesh(two_spheres(), folder / "a.obj"));
  EXPECT_EQ(content(folder / "a.obj").substr(0, 13), "mtllib a.mtl\n");
  const std::string library = content(folder / "a.mtl");
  EXPECT_NE(library.find("newmtl left_eye_2\nKd 0.7"), std::string::npos) << library;

  Model plain = two_spheres();
  for (MeshPart& part : plain.parts) part.mesh.colors.clear();
  ASSERT_TRUE(write_mesh(plain, folder / "b.obj"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.mtl"));
}

TEST(Obj, SameModelSameBytes) {
  const Folder folder;
  ASSERT_TRUE(write_mesh(two_spheres(), folder / "a.obj"));
  ASSERT_TRUE(write_mesh(two_spheres(), folder / "x/../b.obj") ||
              write_mesh(two_spheres(), folder / "b.obj"));
  const std::string a = content(folder / "a.obj"), b = content(folder / "b.obj");
  EXPECT_EQ(a.substr(a.find('\n')), b.substr(b.find('\n')));
}

TEST(Obj, PolygonsNegativeIndicesAndComments) {
  const Result<Model> read = read_obj(
      "# a square and a triangle\r\nv 0 0 0\r\nv 1 0 0\r\nv +1 1 0 1.0\nv 0 1 0\n"
      "vt 0 0\nf -4/1 -3/1 -2/1 -1/1 # all four\nf 1 2 3\n",
      "square.obj");
  ASSERT_TRUE(read) << first_message(read);
  ASSERT_EQ(read->parts.size(), 1u);
  EXPECT_EQ(read->parts[0].name, "square");
  const std::vector<std::array<TriangleMesh::Index, 3>> expected = {
      {0, 1, 2}, {0, 2, 3}, {0, 1, 2}};
  EXPECT_EQ(read->parts[0].mesh.triangles, expected);
}

TEST(Obj, GroupsOfOneSurfaceStayTogether) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n";
  const Result<Model> apart = read_obj(head + "g a\nf 1 2 3\ng b\nf 4 5 6\n", "f");
  ASSERT_TRUE(apart);
  ASSERT_EQ(apart->parts.size(), 2u);
  EXPECT_EQ(apart->parts[1].name, "b");
  EXPECT_EQ(apart->parts[1].mesh.positions.size(), 3u);
  const Result<Model> joined = read_obj(head + "g a\nf 1 2 3\ng b\nf 3 5 6\n", "f");
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->parts.size(), 1u);
}

TEST(Obj, SaysWhereItIsBroken) {
  const auto message = [](const char* text) { return first_message(read_obj(text, "x.obj")); };
  EXPECT_EQ(message("v 0 0\n"), "x.obj:1: error: a coordinate is missing");
  EXPECT_EQ(message("v 0 0 0\nv 0 nan 0\n"), "x.obj:2: error: not a finite number: 'nan'");
  EXPECT_EQ(message("v 1e999 0 0\n"), "x.obj:1: error: not a finite number: '1e999'");
  EXPECT_EQ(message("v 0 0 0\nf 1 1 2\n"), "x.obj:2: error: no such vertex: '2'");
  EXPECT_EQ(message("v 0 0 0\nf 1 0 1\n"), "x.obj:2: error: no such vertex: '0'");
  EXPECT_EQ(message("v 0 0 0\nf 1 1\n"), "x.obj:2: error: a face needs three corners");
  EXPECT_EQ(message("v 0 0 0\nf 1//1 1//1 1//1\n"), "x.obj:2: error: no such normal: '1//1'");
  EXPECT_EQ(message("hello\n"), "x.obj: error: no vertices: not a Wavefront OBJ file");
  EXPECT_EQ(message(""), "x.obj: error: no vertices: not a Wavefront OBJ file");
}

TEST(Obj, SurvivesDamage) {
  const Folder folder;
  Model model;
  model.parts.push_back({"a", sphere_mesh(0)});
  model.parts.push_back({"b", sphere_mesh(0, {3, 0, 0})});
  ASSERT_TRUE(write_mesh(model, folder / "a.obj"));
  expect_survives_damage(content(folder / "a.obj"), MeshFormat::obj);
}

}  // namespace
}  // namespace cs2mesh
