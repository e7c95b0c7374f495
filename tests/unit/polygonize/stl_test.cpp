#include "polygonize/stl.h"

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;

TEST(Stl, RoundTripIsTheRoundedMesh) {
  const Folder folder;
  Model model = two_spheres();
  ASSERT_TRUE(write_mesh(model, folder / "a.stl"));
  EXPECT_EQ(content(folder / "a.stl").size(), 84 + 50 * model.triangle_count());
  const Result<Model> read = read_mesh(folder / "a.stl");
  ASSERT_TRUE(read) << first_message(read);
  ASSERT_EQ(read->parts.size(), 1u);
  const TriangleMesh& mesh = read->parts[0].mesh;
  EXPECT_EQ(mesh.positions.size(), model.vertex_count());
  round_to_format(model, MeshFormat::stl);
  std::size_t t = 0;
  for (const MeshPart& part : model.parts) {
    for (const auto& triangle : part.mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.positions[mesh.triangles[t][k]], part.mesh.positions[triangle[k]]);
      }
      ++t;
    }
  }
  EXPECT_EQ(mesh.triangles.size(), t);
}

TEST(Stl, ReadsAscii) {
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n"
      " endloop\nendfacet\n";
  const std::string other =
      "facet normal 0 0 1\n outer loop\n  vertex 1 0 0\n  vertex 1 1e0 -0\n  vertex 0 1 0\n"
      " endloop\nendfacet\n";
  const Result<Model> read = read_stl(
      "solid two words\n" + facet + other + "endsolid\nsolid b\n" + facet + "endsolid b\n", "f");
  ASSERT_TRUE(read) << first_message(read);
  ASSERT_EQ(read->parts.size(), 2u);
  EXPECT_EQ(read->parts[0].name, "two words");
  EXPECT_EQ(read->parts[0].mesh.positions.size(), 4u);
  EXPECT_EQ(read->parts[1].mesh.triangles.size(), 1u);
  expect_survives_damage("solid a\n" + facet + other + "endsolid\n", MeshFormat::stl);
}

TEST(Stl, SaysWhereItIsBroken) {
  const auto message = [](const std::string& text) {
    return first_message(read_stl(text, "x.stl"));
  };
  EXPECT_EQ(message(""), "x.stl: error: not an STL file");
  EXPECT_EQ(message("solid a\nfacet\nvertex 0 0 inf\n"),
            "x.stl:3: error: a vertex needs three finite numbers");
  EXPECT_EQ(message("solid a\nvertex 0 0 0\nendfacet\n"),
            "x.stl:3: error: a facet needs three vertices");
  EXPECT_EQ(message("solid a\nwhat\n"), "x.stl:2: error: not a line of an ASCII STL file");
  std::string binary(84, ' ');
  binary[80] = binary[81] = '\0';
  binary[82] = binary[83] = '\0';
  binary[80] = '\5';
  EXPECT_EQ(message(binary),
            "x.stl: error: the file ends before its last triangle: its header counts 5");
}

TEST(Stl, RefusesWhatFloatsCannotHold) {
  const Folder folder;
  Model model;
  model.parts.push_back({"far", sphere_mesh(0, {1e39, 0, 0})});
  for (const char* name : {"a.stl", "a.glb"}) {
    const Result<Done> result = write_mesh(model, folder / name);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.diagnostics().front().failure, Failure::output);
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
}

TEST(Stl, SurvivesDamage) {
  const Folder folder;
  Model model;
  model.parts.push_back({"a", sphere_mesh(1)});
  ASSERT_TRUE(write_mesh(model, folder / "a.stl"));
  expect_survives_damage(content(folder / "a.stl"), MeshFormat::stl);
}

TEST(MeshFile, ReadsOff) {
  const std::string text =
      "OFF # Geomview\n\n4 2 0\n0 0 0\n1 0 0 # second\n1 1 0\n0 1 0\n4 0 1 2 3 1 0 0\n3 0 1 2\n";
  const Result<Model> read = read_mesh(text, MeshFormat::off, "x.off");
  ASSERT_TRUE(read) << first_message(read);
  EXPECT_EQ(read->parts[0].mesh.triangles.size(), 3u);
  EXPECT_EQ(first_message(read_mesh("OFF 1 1 0\n0 0 0\n3 0 0 1\n", MeshFormat::off, "x.off")),
            "x.off:3: error: a face has an index that is no vertex");
  expect_survives_damage(text, MeshFormat::off);
}

TEST(MeshFile, ExtensionDecides) {
  EXPECT_EQ(mesh_format_of("a.b/C.GLB"), MeshFormat::glb);
  EXPECT_EQ(mesh_format_of("a.obj/c"), std::nullopt);
  const Result<Done> written = write_mesh(two_spheres(), "a.xyz");
  ASSERT_FALSE(written);
  EXPECT_EQ(to_string(written.diagnostics().front()),
            "a.xyz: error: cannot write a mesh with this extension; there are .obj .ply .stl .glb");
  EXPECT_EQ(first_message(read_mesh("none/a.obj")), "none/a.obj: error: cannot read: no such file");
}

}  // namespace
}  // namespace cs2mesh
