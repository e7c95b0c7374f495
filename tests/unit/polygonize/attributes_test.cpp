#include "polygonize/attributes.h"

#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;
using namespace analytic;

TEST(Attributes, NormalsAreOutwardGradients) {
  const Vec3d center{0.5, 1, -2};
  TriangleMesh mesh = sphere_mesh(4, center, 3);
  mesh.normals.clear();
  add_normals(mesh, Surface<Sphere>(Sphere{center, 3}));
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    EXPECT_LT(norm(Vec3d(mesh.normals[i]) - (mesh.positions[i] - center) / 3.0), 1e-6);
  }
}

TEST(Attributes, FacesStandInWhereTheGradientVanishes) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  mesh.triangles = {{0, 2, 1}};
  add_normals(mesh, Surface<Sphere>());
  EXPECT_EQ(mesh.normals[0], Vec3<float>(0, 0, -1));
  EXPECT_EQ(mesh.normals[1], Vec3<float>(1, 0, 0));
  EXPECT_EQ(mesh.normals[3], Vec3<float>(0, 0, 1));  // no face either
}

struct Tiny {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(1e-200) * (T(1.0) - p.x);
  }
  Aabb bounds() const { return {}; }
};

TEST(Attributes, TinyGradientsStillPointSomewhere) {
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}};
  add_normals(mesh, Surface<Tiny>());
  EXPECT_EQ(mesh.normals[0], Vec3<float>(1, 0, 0));
}

class Halves final : public MaterialBlend {
 public:
  void shares(const Vec3d& point, std::vector<MaterialShare>& shares) const override {
    shares = {{0, point.x}, {1, 1 - point.x}};
  }
};

TEST(Attributes, ColorsMixAsLight) {
  std::vector<Material> materials(2);
  materials[0].diffuse = {1, 1, 0.5};
  materials[1].diffuse = {0, 1, 0.5};
  TriangleMesh mesh;
  mesh.positions = {{0.5, 0, 0}, {1, 0, 0}};
  add_colors(mesh, Halves(), materials);
  ASSERT_EQ(mesh.colors.size(), 2u);
  EXPECT_FLOAT_EQ(mesh.colors[0].x, 0.5F);
  EXPECT_FLOAT_EQ(mesh.colors[0].y, 1.0F);
  EXPECT_FLOAT_EQ(mesh.colors[0].z, 0.21404114F);
  EXPECT_FLOAT_EQ(mesh.colors[1].x, 1.0F);
  EXPECT_THROW(add_colors(mesh, Halves(), {}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
