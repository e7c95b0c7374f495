// Printing and reading back.
#include "libfield/art/print_art.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "art_testing.h"
#include "libfield/art/decompose.h"
#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-13;  // relative, of what returns to a few ulp

void expect_near(const Vec3d& a, const Vec3d& b, double scale) {
  EXPECT_LE(norm(a - b), kTolerance * scale);
}

void expect_near(const Affine& a, const Affine& b) {
  double scale = 0;
  for (const Vec3d& row : a.linear.row) scale = std::max(scale, norm(row));
  for (std::size_t i = 0; i < 3; ++i) expect_near(a.linear.row[i], b.linear.row[i], scale);
  EXPECT_EQ(a.translation, b.translation);
}

void expect_same(const Primitive& a, const Primitive& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const Point* p = std::get_if<Point>(&a)) {
    EXPECT_EQ(p->position, std::get<Point>(b).position);
  } else if (const Segment* s = std::get_if<Segment>(&a)) {
    EXPECT_EQ(s->a, std::get<Segment>(b).a);
    EXPECT_EQ(s->b, std::get<Segment>(b).b);
  } else if (const Triangle* t = std::get_if<Triangle>(&a)) {
    EXPECT_EQ(t->vertex, std::get<Triangle>(b).vertex);
  } else if (const Plane* plane = std::get_if<Plane>(&a)) {
    EXPECT_EQ(plane->point, std::get<Plane>(b).point);
    expect_near(plane->normal, std::get<Plane>(b).normal, 1);
  } else {
    const Arc& x = std::get<Arc>(a);
    const Arc& y = std::get<Arc>(b);
    const double scale = 10 * (norm(x.center) + x.radius);
    expect_near(x.center, y.center, scale);
    EXPECT_NEAR(x.radius, y.radius, kTolerance * scale);
    expect_near(x.radius * x.ex, y.radius * y.ex, scale);
    EXPECT_NEAR(std::abs(dot(x.ey, y.ey)), 1, kTolerance);
    EXPECT_NEAR(x.sweep, y.sweep, kTolerance * scale);
  }
}

void expect_same(const Material& a, const Material& b) {
  EXPECT_EQ(a.diffuse, b.diffuse);
  EXPECT_EQ(a.ambient, b.ambient);
  EXPECT_EQ(a.specular, b.specular);
  EXPECT_EQ(a.shine, b.shine);
  EXPECT_EQ(a.kernel, b.kernel);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.blobbiness, b.blobbiness);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.strength, b.strength);
  EXPECT_EQ(a.profiles, b.profiles);
}

void expect_same_elements(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.elements.size(), b.elements.size());
  for (std::size_t i = 0; i < a.elements.size(); ++i) {
    const Element& x = a.elements[i];
    const Element& y = b.elements[i];
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.spelling, y.spelling);
    EXPECT_EQ(x.own_radius, y.own_radius);
    EXPECT_EQ(x.apex_radius, y.apex_radius);
    EXPECT_EQ(x.taper, y.taper);
    EXPECT_EQ(x.material, y.material);
    EXPECT_EQ(x.object, y.object);
    expect_near(x.transform, y.transform);
    expect_same(x.skeleton, y.skeleton);
    EXPECT_EQ(x.shape, y.shape);
  }
  ASSERT_EQ(a.polygons.size(), b.polygons.size());
  for (std::size_t i = 0; i < a.polygons.size(); ++i) {
    EXPECT_EQ(a.polygons[i].vertex, b.polygons[i].vertex);
  }
  ASSERT_EQ(a.quadrics.size(), b.quadrics.size());
  for (std::size_t i = 0; i < a.quadrics.size(); ++i) {
    EXPECT_EQ(a.quadrics[i].square, b.quadrics[i].square);
    EXPECT_EQ(a.quadrics[i].linear, b.quadrics[i].linear);
    EXPECT_EQ(a.quadrics[i].constant, b.quadrics[i].constant);
    EXPECT_EQ(a.quadrics[i].bounds, b.quadrics[i].bounds);
  }
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
    EXPECT_EQ(a.objects[i].parent, b.objects[i].parent);
    EXPECT_EQ(a.objects[i].blend, b.objects[i].blend);
    expect_near(a.objects[i].transform, b.objects[i].transform);
  }
}

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    expect_same(a.materials[i], b.materials[i]);
  }
  expect_same_elements(a, b);
  EXPECT_EQ(a.camera.eye, b.camera.eye);
  EXPECT_EQ(a.camera.has_eye, b.camera.has_eye);
  EXPECT_EQ(a.camera.look_at, b.camera.look_at);
  expect_near(a.camera.up, b.camera.up, 1);
  EXPECT_EQ(a.camera.fov_horizontal, b.camera.fov_horizontal);
  EXPECT_EQ(a.camera.fov_vertical, b.camera.fov_vertical);
  EXPECT_EQ(a.camera.width, b.camera.width);
  EXPECT_EQ(a.camera.height, b.camera.height);
  EXPECT_EQ(a.camera.samples, b.camera.samples);
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].color, b.lights[i].color);
    EXPECT_EQ(a.lights[i].position, b.lights[i].position);
    EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
    EXPECT_EQ(a.lights[i].shadow, b.lights[i].shadow);
  }
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.soft, b.soft);
  EXPECT_EQ(a.mesh.tolerance, b.mesh.tolerance);
  EXPECT_EQ(a.mesh.cell, b.mesh.cell);
  EXPECT_EQ(a.mesh.bounds, b.mesh.bounds);
  for (std::size_t i = 0; i < a.elements.size(); ++i) {
    EXPECT_EQ(radius_of(a, a.elements[i]), radius_of(b, b.elements[i]));
  }
}

void expect_round_trip(const Scene& scene) {
  const std::string text = print_art(scene);
  SCOPED_TRACE(text.substr(0, 3000));
  expect_same(scene, scene_of(text));
}

TEST(PrintArt, every_scene_of_the_project_reads_back) {
  int count = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(CS2MESH_SOURCE_DIR) / "data" / "scenes")) {
    if (entry.path().extension() != ".art") continue;
    SCOPED_TRACE(entry.path());
    const Result<Scene> scene = read_art(entry.path().string());
    ASSERT_TRUE(scene) << lines_of(scene);
    EXPECT_FALSE(scene->elements.empty());
    expect_round_trip(*scene);
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(PrintArt, everything_the_language_has_reads_back) {
  expect_round_trip(scene_of(
      "eyep 1 2 3\nvup 0 3 0\nsoft off\nfragile arc torus sphere\nmesh tolerance 1e-3 cell 0.1\n"
      "mesh bounds -1 -1 -1, 1 1 1\nlight Red pos 1 2 3 noshadow\nbackground SummerSky\n"
      "texture P strength sin^2 hat scale 2 3 1 bounds 0.1 0 0, 0.9 1 1\n"
      "surface S radius 1 blobbiness -2 texture P + P kernel soft width 3 strength -1\n"
      "surface T shine 3 ambient 10%\n"
      "object Empty\nclose\nsphere S 1 0.1 0.2 0.3\nscale 2 2 -2\n"
      "object A\n  sphere T 1 0 0 0\n  object B\n    blend g\n    pipe S 1 0 0 0 1 0 0\n  close\n"
      "  rotate 1 2 3 77\n  torus S 3 1 1 2 3, 1 1 1\n  object C\n    object D\n    close\n  "
      "close\n"
      "  arc S 2 0.5 1 2 3, -1 0.2 0.1, 200 300\n  arch T 0.5 0 0 0, 1 0.3 0, 2 0 1\nclose\n"
      "scale 1 2 3\nrotate 1 1 0 30\nscale 3 1 -1\ntranslate 1 2 3\n"
      "arch S 1 0 0 0, 1 1 1, 2 2 2\nplane S 0 0 1, 1 2 3\ntriangle S 0 0 0 1 0 0 0 1 0\n"
      "cone S 0.5 0 0 0, 0.25 0 0 1\nbox S 1 0 3, 0 2 1\nbrick S 2 4 6\n"
      "polygon S 0 0.1 0.02, 2 0 0.2, 2.7 1 0.47, 1 0.4 0.18\n"
      "quadric S 1 2 3, 0.1 0.3 6, 7 8 9, -10 bounds 1 1 1, 0 0 0\nquadric S 1 0 0 0 0 0 0 0 1 0\n"
      "dot S 1 2 3\ngauss S 1 2 3\nline S 0 0 0 1 1 1\n"
      "line S 0 0 0 1 1 1 taper 1 0.3\nline S 0 0 0 1 1 1 taper 0.7 -0.1 0.3\n"
      "cylinder S 1 0 0 0 1 1 1 taper 0.1 0.2 0.7\npipe S 1 0 0 0 1 1 1 tap 0 0\n"));
}

TEST(PrintArt, surfaces_of_the_same_name_stay_apart) {
  const Scene scene = scene_of(
      "surface S radius 1\nvar Old = S\nsurface S_2 radius 2\n"
      "surface S radius 3\nsphere S 1 0 0 0\nsphere Old 1 0 0 0\n");
  expect_round_trip(scene);
  EXPECT_EQ(scene_of(print_art(scene)).materials[2].name, "S_3");
}

TEST(Decompose, gives_steps_whose_product_is_the_map) {
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    Affine map;
    for (Vec3d& row : map.linear.row) row = random.uniform(0.01, 3) * random.direction();
    if (i % 4 == 1) map.linear.row[2] = 1e-6 * random.direction();
    if (i % 4 == 2)
      map.linear = Affine::rotate(random.direction(), random.uniform(-180, 180)).linear;
    if (i % 4 == 3)
      map.linear = (Affine::rotate(random.direction(), 180) * Affine::scale({2, 2, -2})).linear;
    map.translation = random.direction();
    Affine product;
    for (const TransformStep& step : decompose(map)) {
      const Affine one = step.kind == TransformStep::Kind::rotate
                             ? Affine::rotate(step.vector, step.degrees)
                         : step.kind == TransformStep::Kind::scale ? Affine::scale(step.vector)
                                                                   : Affine::translate(step.vector);
      product = one * product;
    }
    expect_near(map, product);
  }
  EXPECT_TRUE(decompose(Affine{}).empty());
}

}  // namespace
}  // namespace cs2mesh
