// Meshes scenes with each of our meshers and with the peers that are built in, each row in a
// process of its own, and measures every mesh both ways against the exact surface.
//
//   mesh_bench [SCENE TOLERANCE [SAMPLES [METHOD]]]  one scene; with METHOD, that row alone
//   mesh_bench --tables FOLDER [--all]               the contract's scenes, some from FOLDER
//   mesh_bench --by-triangles FOLDER [--all]         time and memory against triangles
//   mesh_bench --by-primitives [--all]               and against primitives
//
// Without arguments: the spindle cowrie at 0.1 % of its diagonal. Meshing has one thread unless a
// table says so, and a minute (--all: ten). FOLDER holds flake3.art, flake4.art and magra70000.art.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "tests/bench/mesh_growth.h"
#include "tests/bench/mesh_tables.h"

namespace cs2mesh::bench {
namespace {

const std::string kScenes = CS2MESH_SOURCE_DIR "/data/scenes/";

std::vector<const MeshMethod*> all_methods() {
  std::vector<const MeshMethod*> methods;
  for (const MeshMethod& method : mesh_methods()) methods.push_back(&method);
  return methods;
}

int print_one(const char* path, double tolerance, std::size_t samples, std::string_view only) {
  TableRequest request;
  request.subject = {path, path, ""};
  request.tolerance = tolerance;
  request.samples = samples;
  request.most_seconds = 600;
  for (const MeshMethod* method : all_methods()) {
    if (only.empty() || only == method->name) request.methods.push_back(method);
  }
  if (request.methods.empty()) {
    std::fprintf(stderr, "mesh_bench: no method '%s', expected one of\n",
                 std::string(only).c_str());
    for (const MeshMethod& method : mesh_methods()) {
      std::fprintf(stderr, "  %s\n", method.name.data());
    }
    return 2;
  }
  return print_table(request) ? 0 : 2;
}

Subject ball() {
  return {"sphere", "", "surface s { radius 1 blobbiness -2 }\nsphere s 1 <0 0 0>\n"};
}

int print_tables(const std::string& folder, bool all) {
  const auto in_folder = [&](const std::string& name) {
    return Subject{name, folder + "/" + name + ".art", ""};
  };
  const auto of_ours = [](const std::string& name) {
    return Subject{name, kScenes + name + ".art", ""};
  };
  struct Entry {
    Subject subject;
    double tolerance;
    int threads;
    bool quick;  ///< also without --all
  };
  const std::vector<Entry> entries{
      {ball(), 1e-3, 1, true},
      {of_ours("cowrie"), -1e-3, 1, true},
      {in_folder("flake3"), 3.6e-3, 1, true},
      {ball(), 1e-4, 1, false},
      {of_ours("seahorse"), -1e-3, 1, false},
      {in_folder("flake3"), 3.6e-4, 1, false},
      {in_folder("flake4"), 3.6e-3, 1, false},
      {in_folder("magra70000"), 6.3e-3, 2, false},
  };
  int status = 0;
  for (const Entry& entry : entries) {
    if (!entry.quick && !all) continue;
    TableRequest request;
    request.subject = entry.subject;
    request.tolerance = entry.tolerance;
    request.threads = entry.threads;
    request.methods = all_methods();
    request.samples = all ? 1'000'000 : 200'000;
    request.most_seconds = all ? 600 : 60;
    if (!print_table(request)) status = 2;
  }
  return status;
}

GrowthRequest growth(bool all) {
  GrowthRequest request;
  request.method = &mesh_methods().front();
  if (all) {
    request.most_triangles = 1e7;
    request.most_primitives = 1e5;
    request.most_seconds = 1200;
  }
  return request;
}

int run(std::vector<std::string> words) {
  const bool all = !words.empty() && words.back() == "--all";
  if (all) words.pop_back();
  if (words.empty()) return print_one((kScenes + "cowrie.art").c_str(), -1e-3, 100'000, {});
  if (words[0] == "--tables" && words.size() == 2) return print_tables(words[1], all);
  if (words[0] == "--by-triangles" && words.size() == 2) {
    print_growth_by_triangles(ball(), growth(all));
    print_growth_by_triangles({"flake3", words[1] + "/flake3.art", ""}, growth(all));
    return 0;
  }
  if (words[0] == "--by-primitives" && words.size() == 1) {
    print_growth_by_primitives(growth(all));
    return 0;
  }
  if (!all && words.size() >= 2 && words.size() <= 4) {
    const double tolerance = std::strtod(words[1].c_str(), nullptr);
    const std::size_t samples =
        words.size() > 2 ? std::strtoull(words[2].c_str(), nullptr, 10) : 100'000;
    if (tolerance > 0) {
      return print_one(words[0].c_str(), tolerance, samples, words.size() > 3 ? words[3] : "");
    }
  }
  std::fprintf(stderr,
               "usage: mesh_bench [SCENE TOLERANCE [SAMPLES [METHOD]]]\n"
               "       mesh_bench --tables FOLDER [--all]\n"
               "       mesh_bench --by-triangles FOLDER [--all]\n"
               "       mesh_bench --by-primitives [--all]\n");
  return 2;
}

}  // namespace
}  // namespace cs2mesh::bench

int main(int argc, char** argv) {
  return cs2mesh::bench::run(std::vector<std::string>(argv + 1, argv + argc));
}
