// Small meshes, and what every reader must survive.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <string>

#include "libfield/base/random.h"
#include "polygonize/mesh_file.h"

namespace cs2mesh::test {

/// The unit octahedron, each face cut into 4^levels, moved onto the sphere. Closed, outwards.
inline TriangleMesh sphere_mesh(int levels, const Vec3d& center = {}, double radius = 1) {
  using Index = TriangleMesh::Index;
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [found, fresh] = middles.emplace(std::minmax(a, b), mesh.positions.size());
      if (fresh) mesh.positions.push_back(normalized(mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        finer.push_back(t);
      }
    }
    mesh.triangles = finer;
  }
  for (Vec3d& p : mesh.positions) {
    mesh.normals.push_back(Vec3<float>(p));
    mesh.colors.push_back(Vec3<float>(0.5 * (p + Vec3d{1, 1, 1})));
    p = center + radius * p;
  }
  return mesh;
}

/// The same without attributes.
inline TriangleMesh bare_sphere(const Vec3d& center, double radius, int levels = 2) {
  TriangleMesh mesh = sphere_mesh(levels, center, radius);
  mesh.normals.clear();
  mesh.colors.clear();
  return mesh;
}

/// Two parts with coordinates that float32 cannot hold.
inline Model two_spheres() {
  Model model;
  model.parts.push_back({"soft", sphere_mesh(2, {0.1, 0.2, 1.0 / 3}, 0.7)});
  model.parts.push_back({"left eye 2", sphere_mesh(1, {3.0, 1e-7, -2.0}, std::numbers::pi / 10)});
  return model;
}

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cs2mesh-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void expect_valid(const Result<Model>& result) {
  if (!result) {
    ASSERT_FALSE(result.diagnostics().empty());
    EXPECT_FALSE(result.diagnostics().front().message.empty());
    return;
  }
  for (const MeshPart& part : result->parts) {
    const TriangleMesh& mesh = part.mesh;
    for (const Vec3d& p : mesh.positions) EXPECT_TRUE(is_finite(p));
    for (const auto& triangle : mesh.triangles) {
      for (const auto vertex : triangle) EXPECT_LT(vertex, mesh.positions.size());
    }
    EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == mesh.positions.size());
  }
}

/// Cuts the file at every length and changes bytes: each reading gives a valid mesh or a message.
inline void expect_survives_damage(const std::string& bytes, MeshFormat format) {
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    // Every length near the head, where counts are; every seventh after.
    if (length < 1500 || length % 7 == 0) {
      expect_valid(read_mesh(std::string_view(bytes).substr(0, length), format, "cut"));
    }
  }
  Random random(7);
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = bytes;
    const int changes = 1 + static_cast<int>(random.bits() % 3);
    for (int i = 0; i < changes; ++i) {
      // Half of the changes go to the head, where they do most harm.
      const std::size_t range = random.bits() % 2 ? damaged.size() : damaged.size() / 8 + 1;
      damaged[random.bits() % range] = static_cast<char>(random.bits());
    }
    expect_valid(read_mesh(damaged, format, "damaged"));
  }
}

inline std::string first_message(const Result<Model>& result) {
  return result ? "" : to_string(result.diagnostics().front());
}

}  // namespace cs2mesh::test
