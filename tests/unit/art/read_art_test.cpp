// What the commands do to the scene.
#include "libfield/art/read_art.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "art_testing.h"

namespace cs2mesh {
namespace {

const std::string kSurface = "surface S radius 1 blobbiness -2\n";

double distance(const Vec3d& a, const Vec3d& b) {
  return norm(a - b);
}

TEST(Surfaces, every_keyword) {
  const Scene scene = scene_of(
      "surface S { body 0.5 1 0, diff 50%, amb 0.1 0.2 0.3, spec 40%, refl 10%, trans White,\n"
      "  index 1.3 disp 0.1 shine 30 rad 2 blob -3 stren -0.5 skip shadow pixel\n"
      "  kernel gauss width 0.7 }\n");
  ASSERT_EQ(scene.materials.size(), 1u);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.diffuse, (Color{0.25, 0.5, 0}));
  EXPECT_EQ(m.ambient, (Color{0.1, 0.2, 0.3}));
  EXPECT_EQ(m.specular, (Color{0.4, 0.4, 0.4}));
  EXPECT_EQ(m.shine, 30);
  EXPECT_EQ(m.radius, 2);
  EXPECT_EQ(m.blobbiness, -3);
  EXPECT_EQ(m.strength, -0.5);
  EXPECT_EQ(m.kernel, KernelKind::gaussian);
  EXPECT_EQ(m.width, 0.7);
}

TEST(Surfaces, percentages_are_of_the_body_wherever_it_stands) {
  EXPECT_EQ(scene_of("surface S diffuse 50% body Red").materials[0].diffuse, (Color{0.5, 0, 0}));
  EXPECT_EQ(scene_of("surface S body Red").materials[0].diffuse, (Color{1, 0, 0}));
  EXPECT_EQ(scene_of("surface S").materials[0].diffuse, (Color{1, 1, 1}));
}

TEST(Surfaces, kernels_by_every_name) {
  const std::pair<const char*, KernelKind> kNames[] = {
      {"cauchy", KernelKind::cauchy},      {"gaussian", KernelKind::gaussian},
      {"inverse", KernelKind::inverse},    {"squared", KernelKind::squared},
      {"metaball", KernelKind::metaball},  {"soft", KernelKind::soft},
      {"quartic", KernelKind::quartic},    {"invsquared", KernelKind::squared},
      {"metaballs", KernelKind::metaball}, {"meta", KernelKind::metaball}};
  for (const auto& [name, kind] : kNames) {
    const std::string text = std::string("surface S kernel ") + name;
    EXPECT_EQ(scene_of(text).materials.at(0).kernel, kind) << name;
  }
}

TEST(Surfaces, assignment_copies_and_redefinition_replaces) {
  const Scene scene = scene_of(kSurface +
                               "surface T = S\nsphere S 1 0 0 0\n"
                               "surface S radius 5 blobbiness -1\nsphere S 1 0 0 0\n"
                               "var M = T\nsphere M 1 0 0 0\n");
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[1].radius, 1);
  EXPECT_EQ(scene.materials[1].name, "T");
  EXPECT_EQ(scene.elements[0].material, 0);
  EXPECT_EQ(scene.elements[1].material, 2);
  EXPECT_EQ(scene.elements[2].material, 1);
}

TEST(Textures, strength_profiles_multiply_in_order) {
  const Scene scene = scene_of(
      "var Lo = 0.5 0.6 0.7\n"
      "texture A strength sin one bounds Lo White scale 22 3 1 times 1.15 1 1 translate 4 5 6\n"
      "texture B strength sin^2 hat\n"
      "texture C = A + B\n"
      "texture D { pigment Red, scale 2 2 1, mask 1 0 1 0 }\n"
      "surface S texture A + B\nsurface T texture C+B + D\n");
  const auto& profiles = scene.materials[0].profiles;
  ASSERT_EQ(profiles.size(), 2u);
  const StrengthProfile expected{
      ProfileFunction::sin, ProfileFunction::one, 22, 3, 4, 5, 1.15, 0.5, 1.0};
  EXPECT_EQ(profiles[0], expected);
  EXPECT_EQ(profiles[1].along_u, ProfileFunction::sin_squared);
  EXPECT_EQ(profiles[1].along_v, ProfileFunction::hat);
  EXPECT_EQ(scene.materials[1].profiles.size(), 3u);
}

TEST(Variables, every_type_stands_where_its_type_may) {
  const Scene scene = scene_of(
      "var r = 0.25 hot\nvar P = 1 r 3\nvar Q = P\nvar Paint = SummerSky\nvar Fat = 2\n"
      "surface S diffuse Paint radius Fat blobbiness -1 ambient P\n"
      "var Mat = S\nsphere Mat r Q\nvar r = 7\nsphere S r, 0 r 0\n");
  EXPECT_EQ(scene.materials[0].diffuse, (Color{0.22, 0.69, 0.87}));
  EXPECT_EQ(scene.materials[0].ambient, (Color{1, 0.25, 3}));
  EXPECT_EQ(scene.materials[0].radius, 2);
  EXPECT_EQ(scene.elements[0].own_radius, 0.25);
  EXPECT_EQ(std::get<Point>(scene.elements[0].skeleton).position, (Vec3d{1, 0.25, 3}));
  EXPECT_EQ(std::get<Point>(scene.elements[1].skeleton).position, (Vec3d{0, 7, 0}));
}

TEST(Defines, win_over_the_scene) {
  ReadArtOptions options;
  options.defines = {{"r", "3"}, {"C", "Red"}, {"P", "1 2 3"}};
  const Scene scene = scene_of(
      "var r = 1\nvar C = Blue\nreset all\nvar P = 0 0 0\n"
      "surface S diffuse C radius 1\nsphere S r P\n",
      options);
  EXPECT_EQ(scene.elements[0].own_radius, 3);
  EXPECT_EQ(scene.materials[0].diffuse, (Color{1, 0, 0}));
  EXPECT_EQ(std::get<Point>(scene.elements[0].skeleton).position, (Vec3d{1, 2, 3}));
}

TEST(Defines, broken_ones_are_reported) {
  const auto said = [](const std::string& name, const std::string& value) {
    ReadArtOptions options;
    options.defines = {{name, value}};
    return said_of("soft on\n", options);
  };
  EXPECT_EQ(said("r", "x1"),
            "-D r=x1: error: found 'x1', expected a number, a variable, a "
            "surface, a texture or a color\n");
  EXPECT_EQ(said("r", "1\nsoft off"),
            "-D r=1\nsoft off: error: found another line, expected a value\n");
  EXPECT_EQ(said("r", "\x01"), "-D r=\x01: error: this is not text, expected name=value\n");
}

TEST(Primitives, each_makes_its_skeleton) {
  const Scene scene = scene_of(
      kSurface +
      "sphere S 2 1 2 3\ncylinder S 0.5 0 0 0 1 0 0\npipe S 0.5 0 0 0 1 0 0\n"
      "line S 0 0 0 0 0 1\ndot S 1 1 1\ngauss S 2 2 2\ntriangle S 0 0 0 1 0 0 0 1 0\n"
      "plane S 0 0 1, 0 0 5\narc S 2 0.1 <1 0 0> <0 0 1> 0 90\ntorus S 2 0.1 0 0 0, 0 1 0\n"
      "arch S 0.1 1 0 0, 0 1 0, -1 0 0\narch S 0.1 0 0 0, 1 0 0, 2 0 0\n"
      "cone S 0.5 0 0 0, 0.25 0 0 1\nbox S 1 0 3, 0 2 1\nbrick S 2 4 6\n"
      "polygon S 0 0 0, 2 0 0, 2 1 0, 0 1 0\n"
      "quadric S 1 2 3, 4 5 6, 7 8 9, -10 bounds 1 1 1, 0 0 0\n");
  const auto& e = scene.elements;
  ASSERT_EQ(e.size(), 17u);
  const ElementKind kKinds[] = {ElementKind::sphere,   ElementKind::cylinder, ElementKind::cylinder,
                                ElementKind::line,     ElementKind::dot,      ElementKind::gauss,
                                ElementKind::triangle, ElementKind::plane,    ElementKind::arc,
                                ElementKind::arc,      ElementKind::arch,     ElementKind::arch,
                                ElementKind::cone,     ElementKind::box,      ElementKind::box,
                                ElementKind::polygon,  ElementKind::quadric};
  for (std::size_t i = 0; i < e.size(); ++i) EXPECT_EQ(e[i].kind, kKinds[i]) << i;
  EXPECT_EQ(e[0].own_radius, 2);
  EXPECT_EQ(e[1].own_radius, 0.5);
  EXPECT_EQ(e[2].spelling, Spelling::pipe);
  EXPECT_FALSE(e[3].own_radius);
  EXPECT_EQ(std::get<Segment>(e[3].skeleton).b, (Vec3d{0, 0, 1}));
  EXPECT_EQ(std::get<Triangle>(e[6].skeleton).vertex[2], (Vec3d{0, 1, 0}));
  EXPECT_EQ(std::get<Plane>(e[7].skeleton).normal, (Vec3d{0, 0, 1}));
  const Arc& arc = std::get<Arc>(e[8].skeleton);
  EXPECT_EQ(arc.radius, 2);
  EXPECT_NEAR(arc.sweep, std::acos(0), 1e-15);
  EXPECT_LT(distance(arc.ex, {std::sqrt(0.5), std::sqrt(0.5), 0}), 1e-15);
  EXPECT_EQ(e[9].spelling, Spelling::torus);
  EXPECT_NEAR(std::get<Arc>(e[9].skeleton).sweep, 4 * std::acos(0), 1e-15);
  EXPECT_LT(norm(std::get<Arc>(e[10].skeleton).center), 1e-15);
  EXPECT_EQ(std::get<Segment>(e[11].skeleton).b, (Vec3d{2, 0, 0}));
  EXPECT_EQ(e[11].where, (SourceLocation{"test.art", 13, 1}));
  EXPECT_EQ(e[12].own_radius, 0.5);
  EXPECT_EQ(e[12].apex_radius, 0.25);
  EXPECT_EQ(std::get<Segment>(e[13].skeleton).a, (Vec3d{0, 0, 1}));
  EXPECT_EQ(std::get<Segment>(e[13].skeleton).b, (Vec3d{1, 2, 3}));
  EXPECT_EQ(std::get<Segment>(e[14].skeleton).a, (Vec3d{-1, -2, -3}));
  EXPECT_FALSE(is_soft(scene, e[14]));
  EXPECT_EQ(std::get<Triangle>(e[15].skeleton).vertex[2], (Vec3d{0, 1, 0}));
  EXPECT_EQ(scene.polygons.at(0).vertex.at(2), (Vec3d{2, 1, 0}));
  EXPECT_TRUE(is_soft(scene, e[15]));
  const Quadric& quadric = scene.quadrics.at(0);
  EXPECT_EQ(quadric.square, (Symmetric3{1, 2, 3, 2, 2.5, 3}));
  EXPECT_EQ(quadric.linear, (Vec3d{7, 8, 9}));
  EXPECT_EQ(quadric.constant, -10);
  EXPECT_EQ(quadric.bounds, (Aabb{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_FALSE(is_soft(scene, e[16]));
}

TEST(Primitives, the_radius_in_force_follows_fragile) {
  const std::string text =
      "surface S radius 9 blobbiness -1\nsphere S 1 0 0 0\n"
      "cylinder S 1 0 0 0 1 0 0\npipe S 1 0 0 0 1 0 0\n"
      "arc S 2 1 0 0 0 0 0 1 0 90\ntorus S 2 1 0 0 0 0 0 1\n"
      "arch S 1 1 0 0 0 1 0 -1 0 0\ncone S 0.5 0 0 0 1 0 0 4\n";
  const auto radii = [&](const std::string& line) {
    const Scene scene = scene_of(text + line);
    std::string radii;
    for (const Element& e : scene.elements) radii += radius_of(scene, e) == 9 ? 'S' : 'o';
    return radii;
  };
  EXPECT_EQ(radii(""), "ooooooo");
  EXPECT_EQ(radii("fragile all\n"), "SSSSSSS");
  EXPECT_EQ(radii("fragile all\nfragile none\n"), "ooooooo");
  EXPECT_EQ(radii("fragile sphere pipe\n"), "SoSoooo");
  EXPECT_EQ(radii("fragile sphere\nfragile cylinder\n"), "oSooooo");
  EXPECT_EQ(radii("fragile arc\n"), "oooSooo");
  EXPECT_EQ(radii("fragile torus arch\n"), "ooooSSo");
}

TEST(Primitives, both_radii_of_a_cone_follow_fragile) {
  const std::string text = "surface S radius 9 blobbiness -1\ncone S 0.5 0 0 0 1.5 0 0 4\n";
  const auto radii = [&](const std::string& line) {
    const Scene scene = scene_of(text + line);
    return cone_radii(scene, scene.elements[0]);
  };
  EXPECT_EQ(radii("").base, 0.5);
  EXPECT_EQ(radii("").apex, 1.5);
  EXPECT_EQ(radii("fragile cone\n").base, 3);
  EXPECT_EQ(radii("fragile cone\n").apex, 9);
}

TEST(Objects, nest_and_chain) {
  const Scene scene = scene_of(kSurface +
                               "sphere S 1 0 0 0\nobject A\n  sphere S 1 0 0 0\n"
                               "  chain S balls\n    sphere 1 0 0 0\n    sphere 2 0 0 0\n  close\n"
                               "close A\n");
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "A");
  EXPECT_EQ(scene.objects[0].parent, -1);
  EXPECT_EQ(scene.objects[1].name, "balls");
  EXPECT_EQ(scene.objects[1].parent, 0);
  ASSERT_EQ(scene.elements.size(), 4u);
  EXPECT_EQ(scene.elements[0].object, -1);
  EXPECT_EQ(scene.elements[1].object, 0);
  EXPECT_EQ(scene.elements[3].object, 1);
}

TEST(Objects, transforms_act_on_the_last_or_the_named) {
  const Scene scene = scene_of(kSurface +
                               "object A\n  sphere S 1 0 0 0\n  translate 1 0 0\n"
                               "  sphere S 1 0 0 0\n  scale 2 2 2\n  translate 0 0 1\nclose\n"
                               "rotate 0 0 1 90\nsphere S 1 0 0 0\ntranslate 0 5 0 A\n");
  const auto center = [&](std::size_t i) {
    return world_transform(scene,
                           scene.elements[i])(std::get<Point>(scene.elements[i].skeleton).position);
  };
  EXPECT_LT(distance(center(0), {0, 6, 0}), 1e-15);
  EXPECT_LT(distance(center(1), {0, 5, 1}), 1e-15);
  EXPECT_EQ(scene.elements[1].transform.linear.row[0].x, 2);
  EXPECT_EQ(center(2), Vec3d{});
}

TEST(Objects, blend_groups) {
  const Scene scene = scene_of(
      "object A\nblend\nclose\nobject B\nblend hands\nclose\n"
      "object C\nclose\n");
  EXPECT_EQ(scene.objects[0].blend, "");
  EXPECT_EQ(scene.objects[1].blend, "hands");
  EXPECT_FALSE(scene.objects[2].blend);
}

TEST(Objects, clones_are_independent) {
  const Scene scene = scene_of(kSurface +
                               "object A\n  blend\n  object In\n    sphere S 1 1 0 0\n  close\n"
                               "close\ntranslate 1 0 0\ninstance A B\ntranslate 0 2 0\n"
                               "translate 0 0 3 A\ninstance B C\ntranslate 9 0 0 C/In\n");
  ASSERT_EQ(scene.objects.size(), 6u);
  ASSERT_EQ(scene.elements.size(), 3u);
  const auto center = [&](std::size_t i) {
    return world_transform(scene, scene.elements[i])({1, 0, 0});
  };
  EXPECT_EQ(center(0), (Vec3d{2, 0, 3}));
  EXPECT_EQ(center(1), (Vec3d{2, 2, 0}));
  EXPECT_EQ(center(2), (Vec3d{11, 2, 0}));
  EXPECT_EQ(scene.objects[3].name, "B/In");
  EXPECT_EQ(scene.objects[5].name, "C/In");
  EXPECT_EQ(scene.objects[2].blend, "");
}

TEST(Objects, remove_takes_all_below) {
  const Scene scene = scene_of(kSurface +
                               "object A\n  object B\n    sphere S 1 0 0 0\n  close\nclose\n"
                               "object C\n  sphere S 2 0 0 0\n  object D\n    sphere S 3 0 0 0\n"
                               "  close\nclose\nremove A\nobject A\n sphere S 4 0 0 0\nclose\n"
                               "remove object D\n");
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "C");
  EXPECT_EQ(scene.objects[1].name, "A");
  ASSERT_EQ(scene.elements.size(), 2u);
  EXPECT_EQ(scene.elements[0].own_radius, 2);
  EXPECT_EQ(scene.elements[1].own_radius, 4);
  EXPECT_EQ(scene.elements[1].object, 1);
}

TEST(SceneCommands, camera_lights_and_options) {
  const Scene scene = scene_of(
      "eyep 1 2 3\nvrp 4 5 6\nvup 0 1 0\nfov 30 40\nframesize 640 480\nsample 4\n"
      "light 1 0.5 0 point pos -10 5 10 noshadow, inten 0.75\nlight White\nbackground Gray\n"
      "soft on\nsoft off\nmesh tol 0.1 cell 0.2\nmesh bounds -1 -2 -3, 1 2 3\n");
  EXPECT_TRUE(scene.camera.has_eye);
  EXPECT_EQ(scene.camera.eye, (Vec3d{1, 2, 3}));
  EXPECT_EQ(scene.camera.look_at, (Vec3d{4, 5, 6}));
  EXPECT_EQ(scene.camera.up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(scene.camera.fov_vertical, 40);
  EXPECT_EQ(scene.camera.width, 640);
  EXPECT_EQ(scene.camera.samples, 4);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].position, (Vec3d{-10, 5, 10}));
  EXPECT_EQ(scene.lights[0].intensity, 0.75);
  EXPECT_FALSE(scene.lights[0].shadow);
  EXPECT_TRUE(scene.lights[1].shadow);
  EXPECT_EQ(scene.background, (Color{190 / 255.0, 190 / 255.0, 190 / 255.0}));
  EXPECT_FALSE(scene.soft);
  EXPECT_EQ(scene.mesh.tolerance, 0.1);
  EXPECT_EQ(scene.mesh.cell, 0.2);
  EXPECT_EQ(scene.mesh.bounds->max, (Vec3d{1, 2, 3}));
}

TEST(SceneCommands, reset_starts_over) {
  const Scene scene = scene_of(kSurface +
                               "object A\nsphere S 1 0 0 0\nclose\nsoft off\n"
                               "eyep 1 1 1\nlight White\nreset model lights\n"
                               "object A\nclose\nsphere S 2 0 0 0\n");
  EXPECT_EQ(scene.elements.size(), 1u);
  EXPECT_EQ(scene.objects.size(), 1u);
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_TRUE(scene.camera.has_eye);
  EXPECT_FALSE(scene.soft);
  EXPECT_TRUE(scene_of("soft off\nreset\n").soft);
}

TEST(ReadArt, an_empty_scene_is_a_scene) {
  EXPECT_TRUE(scene_of("").elements.empty());
  EXPECT_TRUE(scene_of("# nothing\n").elements.empty());
}

TEST(ReadArt, return_and_quit_end_the_file) {
  EXPECT_TRUE(scene_of("return\nnonsense {\n").elements.empty());
  EXPECT_TRUE(scene_of("quit\nnonsense {\n").elements.empty());
}

TEST(ReadArt, close_with_another_name_is_a_warning) {
  EXPECT_EQ(said_of("object A\nclose B\n"),
            "test.art:2:7: warning: 'close' names 'B' but closes 'A'\n");
}

TEST(ReadArt, a_wrong_definition_is_reported_once) {
  EXPECT_EQ(said_of("surface S radius\nvar r = Blu1\ntexture T stren\nsphere S r r\n"
                    "surface U texture T rad r\n"),
            "test.art:1:17: error: the command ends too early, expected the radius in isolation\n"
            "test.art:2:9: error: found 'Blu1', expected a number, a variable, a surface, a "
            "texture or a color, did you mean 'Blue'?\n"
            "test.art:3:16: error: the command ends too early, expected profile function\n");
}

TEST(ReadArt, the_scenes_of_the_thesis) {
  const std::string folder = std::string(CS2MESH_SOURCE_DIR) + "/data/scenes/";
  const Result<Scene> cowrie = read_art(folder + "cowrie.art");
  ASSERT_TRUE(cowrie) << lines_of(cowrie);
  EXPECT_EQ(cowrie->elements.size(), 103u);
  EXPECT_EQ(cowrie->elements[3].where.file, folder + "spikes.dat");
  const Result<Scene> seahorse = read_art(folder + "seahorse.art");
  ASSERT_TRUE(seahorse) << lines_of(seahorse);
  int hard = 0;
  for (const Element& e : seahorse->elements) hard += is_soft(*seahorse, e) ? 0 : 1;
  EXPECT_EQ(hard, 2);
  EXPECT_EQ(seahorse->elements.size(), 43u);
}

TEST(ReadArt, is_fast) {
  std::string text = kSurface;
  for (int i = 0; i < 70000; ++i) text += "  sphere S 0.019949 <-0.425458 0.628969 3.04491>\n";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(scene_of(text).elements.size(), 70000u);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  // About 0.05 s; the bound leaves room for sanitizers on a busy machine.
  EXPECT_LT(seconds.count(), 5.0);
}

}  // namespace
}  // namespace cs2mesh
