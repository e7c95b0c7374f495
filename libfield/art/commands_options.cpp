// Options that bear on the surface or its mesh.
#include <array>

#include "libfield/art/commands.h"

namespace cs2mesh::commands {

void soft(SceneBuilder& builder, Arguments& args) {
  constexpr std::array<std::string_view, 2> kSwitch = {"on", "off"};
  const bool on = args.keyword(kSwitch, "setting") == 0;
  if (args.finish()) builder.scene().soft = on;
}

void fragile(SceneBuilder& builder, Arguments& args) {
  constexpr std::array<std::string_view, 9> kKinds = {"none", "all",      "arc",  "arch",  "torus",
                                                      "pipe", "cylinder", "cone", "sphere"};
  Fragile fragile;
  bool Fragile::*const flags[] = {&Fragile::arc,   &Fragile::arch,     &Fragile::torus,
                                  &Fragile::pipe,  &Fragile::cylinder, &Fragile::cone,
                                  &Fragile::sphere};
  do {
    const std::size_t kind = args.keyword(kKinds, "kind of primitive");
    if (args.failed()) return;
    if (kind == 0) fragile = {};
    for (std::size_t i = 0; i < std::size(flags); ++i) {
      if (kind == 1 || kind == i + 2) fragile.*flags[i] = true;
    }
  } while (args.more());
  if (args.finish()) builder.scene().fragile = fragile;
}

void mesh(SceneBuilder& builder, Arguments& args) {
  constexpr std::array<std::string_view, 4> kKeywords = {"tolerance", "bounds", "cell", "robust"};
  MeshSettings settings = builder.scene().mesh;
  do {
    const std::size_t keyword = args.keyword(kKeywords, "setting of the mesh");
    if (args.failed()) return;
    if (keyword == 0) settings.tolerance = args.positive("the tolerance");
    if (keyword == 2) settings.cell = args.positive("the size of a cell");
    if (keyword == 1) {
      const SourceLocation where = args.here();
      const Vec3d low = args.triple("the least corner, x y z");
      const Vec3d high = args.triple("the greatest corner, x y z");
      if (!args.failed() && !(low.x < high.x && low.y < high.y && low.z < high.z)) {
        args.fail(where,
                  "the box is empty, expected each coordinate of the first corner below the "
                  "second's");
      }
      settings.bounds = Aabb{low, high};
    }
    if (keyword == 3) {
      builder.log().once(Severity::note, "mesh robust", args.opcode_location(),
                         "'mesh robust' does nothing here");
    }
  } while (args.more());
  if (args.finish()) builder.scene().mesh = settings;
}

}  // namespace cs2mesh::commands
