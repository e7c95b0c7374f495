#include "cli/verbs.h"

#include <array>

namespace cs2mesh {
namespace {

constexpr std::array<Verb, 7> kVerbs = {{
    {"render", "render SCENE OUT.png", "ray-trace the reference image", run_render},
    {"compare", "compare SCENE MESH", "measure a mesh against the exact surface", run_compare},
    {"report", "report SCENE OUT.html", "error against run time: tolerances x meshers on a page",
     run_report},
    {"check", "check MESH", "closed? manifold? self-intersecting? where?", run_check},
    {"probe", "probe SCENE POINTS", "field value and gradient at points", run_probe},
    {"info", "info SCENE", "what the scene holds", run_info},
    {"help", "help [VERB|COMMAND]", "the manual, also of each command of the language", run_help},
}};

}  // namespace

std::span<const Verb> all_verbs() {
  return kVerbs;
}

std::string overview() {
  std::string text =
      "cs2mesh " CS2MESH_VERSION
      ": convolution surfaces to meshes one can trust\n\n"
      "  cs2mesh SCENE OUT...                      mesh a scene; the extension picks the format\n";
  for (const Verb& verb : kVerbs) {
    std::string line = "  cs2mesh " + std::string(verb.usage);
    line.resize(std::max<std::size_t>(line.size() + 2, 44), ' ');
    text += line + std::string(verb.summary) + '\n';
  }
  return text +
         "\nOptions: cs2mesh help VERB, or cs2mesh help mesh for those of meshing.\n"
         "Exit status: 0 done, 1 internal error, 2 bad input or usage, 3 the scene cannot be "
         "meshed,\n"
         "4 the mesh failed its check, 5 the tolerance was not reached, 6 a limit of memory or "
         "time,\n"
         "7 an output could not be written, 130 interrupted.\n";
}

}  // namespace cs2mesh
