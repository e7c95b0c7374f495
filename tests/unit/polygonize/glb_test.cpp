#include "polygonize/glb.h"

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;

TEST(Glb, RoundTripIsTheRoundedMeshForAnyUp) {
  const Folder folder;
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}, Vec3d{-1, 0, 0},
                          Vec3d{1, 2, -3}, Vec3d{1e-9, -1, 1e-9}}) {
    Model model = two_spheres();
    MeshFileOptions options;
    options.up = up;
    ASSERT_TRUE(write_mesh(model, folder / "a.glb", options));
    const Result<Model> read = read_mesh(folder / "a.glb");
    ASSERT_TRUE(read) << first_message(read);
    ASSERT_EQ(read->parts.size(), 2u);
    const Model exact = model;
    round_to_format(model, MeshFormat::glb, options);
    for (std::size_t i = 0; i < 2; ++i) {
      const TriangleMesh& in = model.parts[i].mesh;
      const TriangleMesh& out = read->parts[i].mesh;
      EXPECT_EQ(read->parts[i].name, model.parts[i].name);
      EXPECT_EQ(out.positions, in.positions);
      EXPECT_EQ(out.triangles, in.triangles);
      EXPECT_EQ(out.colors, in.colors);
      ASSERT_EQ(out.normals.size(), in.normals.size());
      for (std::size_t k = 0; k < in.normals.size(); ++k) {
        EXPECT_LT(norm(Vec3d(out.normals[k]) - Vec3d(in.normals[k])), 1e-6);
        EXPECT_LT(norm(in.positions[k] - exact.parts[i].mesh.positions[k]), 1e-6);
      }
    }
  }
}

TEST(Glb, TurnsUpToY) {
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 0, -2}, Vec3d{1, 0, 0}, Vec3d{0, -3, 0},
                          Vec3d{1, -1, 2}, Vec3d{1e-8, -1, 0}}) {
    const Mat3 turn = rotation_to_y_up(up);
    EXPECT_LT(norm(turn * normalized(up) - Vec3d(0, 1, 0)), 1e-15);
    EXPECT_NEAR(determinant(turn), 1, 1e-14);
    EXPECT_LT(norm(transpose(turn) * (turn * Vec3d(3, 4, 5)) - Vec3d(3, 4, 5)), 1e-14);
  }
  EXPECT_EQ(rotation_to_y_up({0, 0, 1}) * Vec3d(1, 2, 3), Vec3d(1, 3, -2));
}

TEST(Glb, WideIndicesWhereNeeded) {
  const Folder folder;
  Model model;
  model.parts.push_back({"fine", sphere_mesh(7)});
  ASSERT_GT(model.vertex_count(), 65535u);
  ASSERT_TRUE(write_mesh(model, folder / "a.glb"));
  EXPECT_NE(content(folder / "a.glb").find("\"componentType\":5125"), std::string::npos);
  const Result<Model> read = read_mesh(folder / "a.glb");
  ASSERT_TRUE(read) << first_message(read);
  EXPECT_EQ(read->parts[0].mesh.triangles, model.parts[0].mesh.triangles);
}

TEST(Glb, EmptyModel) {
  const Folder folder;
  ASSERT_TRUE(write_mesh(Model{}, folder / "a.glb"));
  const Result<Model> read = read_mesh(folder / "a.glb");
  ASSERT_TRUE(read) << first_message(read);
  EXPECT_TRUE(read->parts.empty());
}

// One triangle: three corners in base64 (floats 0 0 0, 1 0 0, 0 1 0).
std::string gltf(const std::string& nodes, const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"name":"tri","primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":
"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}])" +
         more + "}";
}

TEST(Glb, NodeTransformsAndMirrors) {
  // +Y up becomes +Z up: (x, y, z) -> (x, -z, y).
  const Result<Model> moved =
      read_glb(gltf(R"([{"children":[1],"translation":[0,0,5]},{"mesh":0,"scale":[2,3,4]}])"), "f");
  ASSERT_TRUE(moved) << first_message(moved);
  EXPECT_EQ(moved->parts[0].name, "tri");
  const std::vector<Vec3d> expected = {{0, -5, 0}, {2, -5, 0}, {0, -5, 3}};
  EXPECT_EQ(moved->parts[0].mesh.positions, expected);
  EXPECT_EQ(moved->parts[0].mesh.triangles[0], (std::array<TriangleMesh::Index, 3>{0, 1, 2}));

  const Result<Model> mirrored = read_glb(gltf(R"([{"mesh":0,"scale":[-1,1,1]}])"), "f");
  ASSERT_TRUE(mirrored);
  EXPECT_EQ(mirrored->parts[0].mesh.triangles[0], (std::array<TriangleMesh::Index, 3>{0, 2, 1}));

  const double h = std::sqrt(0.5);
  const Result<Model> turned = read_glb(
      gltf(R"([{"mesh":0,"rotation":[0,0,)" + std::to_string(h) + "," + std::to_string(h) + "]}]"),
      "f");
  ASSERT_TRUE(turned);
  EXPECT_LT(norm(turned->parts[0].mesh.positions[1] - Vec3d(0, 0, 1)), 1e-5);
}

TEST(Glb, SaysWhatIsWrong) {
  const auto message = [](const std::string& text) {
    return first_message(read_glb(text, "x.glb"));
  };
  const std::string node = R"([{"mesh":0}])";
  EXPECT_EQ(message(""), "x.glb: error: not a glTF file: broken JSON");
  EXPECT_EQ(message(R"({"asset":{"version":"1.0"}})"), "x.glb: error: not glTF version 2");
  EXPECT_EQ(message(gltf(R"([{"mesh":0,"children":[0]}])")), "x.glb: error: the nodes are no tree");
  EXPECT_EQ(message(gltf(R"([{"mesh":7}])")), "x.glb: error: there is no such mesh");
  EXPECT_EQ(
      message(gltf(node, R"(,"extensionsRequired":["KHR_draco_mesh_compression"])")),
      "x.glb: error: the file requires the extension KHR_draco_mesh_compression, not read here");
  EXPECT_EQ(message(gltf(node, R"(,"extensionsRequired":["KHR_materials_unlit"])")), "");
  std::string longer = gltf(node);
  longer.replace(longer.find("\"count\":3"), 9, "\"count\":4");
  EXPECT_EQ(message(longer), "x.glb: error: an accessor reaches beyond its buffer");
  std::string outside = gltf(node);
  outside.replace(outside.find("data:"), 5, "file:");
  EXPECT_EQ(message(outside),
            "x.glb: error: a buffer is in a file of its own; only embedded buffers are read");
}

TEST(Glb, RepetitionIsBounded) {
  std::string nodes = R"([{"children":[1)";
  constexpr int kNodes = 50000;
  for (int i = 2; i <= kNodes; ++i) nodes += ',' + std::to_string(i);
  nodes += "]}";
  for (int i = 1; i <= kNodes; ++i) nodes += R"(,{"mesh":0})";
  std::string text = gltf(nodes + "]");
  const std::string primitive = R"({"attributes":{"POSITION":0}})";
  std::string primitives = primitive;
  for (int i = 0; i < 1000; ++i) primitives += "," + primitive;
  text.replace(text.find(primitive), primitive.size(), primitives);
  const Result<Model> read = read_glb(text, "x.glb");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.diagnostics().front().failure, Failure::limit);
  // Nesting must not go into the call stack.
  EXPECT_FALSE(read_glb(std::string(200000, '['), "x.glb"));
}

TEST(Glb, SurvivesDamage) {
  const Folder folder;
  Model model;
  model.parts.push_back({"a", sphere_mesh(0)});
  ASSERT_TRUE(write_mesh(model, folder / "a.glb"));
  expect_survives_damage(content(folder / "a.glb"), MeshFormat::glb);
  expect_survives_damage(gltf(R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])"),
                         MeshFormat::gltf);
}

}  // namespace
}  // namespace cs2mesh
