#include "polygonize/ply.h"

#include <cstring>

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;

TEST(Ply, RoundTripIsExact) {
  const Folder folder;
  const Model model = two_spheres();
  ASSERT_TRUE(write_mesh(model, folder / "a.ply"));
  const Result<Model> read = read_mesh(folder / "a.ply");
  ASSERT_TRUE(read) << first_message(read);
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
      // Half a step of 8 bits in the coded scale, where the curve is steepest.
      EXPECT_NEAR(norm(Vec3d(out.colors[k]) - Vec3d(in.colors[k])), 0, 0.0085);
    }
  }
}

constexpr const char* kHead =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty uchar flag\nproperty list uchar short vertex_index\nend_header\n";

TEST(Ply, ReadsAscii) {
  const Result<Model> read =
      read_ply(std::string("ply\nformat ascii 1.0\ncomment part of something\n") + kHead +
                   "0 0 0\n1 0 0\n1 1\n0\n0 1 0.5\n7 4 0 1 2 3\n",
               "q.ply");
  ASSERT_TRUE(read) << first_message(read);
  EXPECT_EQ(read->parts[0].name, "q");
  EXPECT_EQ(read->parts[0].mesh.triangles.size(), 2u);
  EXPECT_EQ(read->parts[0].mesh.positions[3], Vec3d(0, 1, 0.5));
}

TEST(Ply, ReadsBigEndian) {
  std::string bytes = std::string("ply\r\nformat binary_big_endian 1.0\r\n") + kHead;
  const auto append = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t i = sizeof value; i-- > 0;) bytes += raw[i];
  };
  for (const float c : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, -2.5F}) append(c);
  bytes += "\7\4";
  for (const std::int16_t i : {0, 1, 2, 3}) append(i);
  const Result<Model> read = read_ply(bytes, "q.ply");
  ASSERT_TRUE(read) << first_message(read);
  EXPECT_EQ(read->parts[0].mesh.triangles.size(), 2u);
  EXPECT_EQ(read->parts[0].mesh.positions[3], Vec3d(0, 1, -2.5));
  expect_survives_damage(bytes, MeshFormat::ply);
}

TEST(Ply, SaysWhereItIsBroken) {
  const auto message = [](const std::string& text) {
    return first_message(read_ply(text, "x.ply"));
  };
  EXPECT_EQ(message("solid"), "x.ply:1: error: not a PLY file: it does not begin with 'ply'");
  EXPECT_EQ(message("ply\nformat weird 1.0\n"), "x.ply:2: error: unknown format 'weird'");
  EXPECT_EQ(message("ply\nelement vertex\n"),
            "x.ply:2: error: an element needs a name and a count");
  EXPECT_EQ(message("ply\nend_header\n"), "x.ply:2: error: the header has no format line");
  EXPECT_EQ(message(std::string("ply\nformat ascii 1.0\n") + kHead + "0 0 0\n1 a 0\n"),
            "x.ply:12: error: the file ends too early, or something is no number, in property y");
  EXPECT_EQ(message(std::string("ply\nformat ascii 1.0\n") + kHead +
                    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n7 4 0 1 2 4\n"),
            "x.ply: error: a face has an index that is no vertex");
}

TEST(Ply, CountsAreNotBelieved) {
  for (const char* count : {"4000000000", "9223372036854775807"}) {
    const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    EXPECT_FALSE(read_ply(
        head + count + "\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        "x.ply"));
    // Rows without bytes: no loop may run over them.
    EXPECT_FALSE(read_ply(head + count + "\nend_header\n", "x.ply"));
  }
}

TEST(Ply, SurvivesDamage) {
  const Folder folder;
  Model model;
  model.parts.push_back({"a", sphere_mesh(0)});
  model.parts.push_back({"b", sphere_mesh(0, {3, 0, 0})});
  ASSERT_TRUE(write_mesh(model, folder / "a.ply"));
  expect_survives_damage(content(folder / "a.ply"), MeshFormat::ply);
}

}  // namespace
}  // namespace cs2mesh
