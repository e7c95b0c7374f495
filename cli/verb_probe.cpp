// cs2mesh probe: the field at given points.
#include <tbb/parallel_for.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "cli/load_scene.h"
#include "cli/verbs.h"
#include "libfield/field/field.h"

namespace cs2mesh {
namespace {

constexpr std::size_t kBatch = 1 << 16;

/// "x y z" a line; blank lines and lines that start with # do not count.
class PointReader {
 public:
  PointReader(const std::string& path, Console& console)
      : name_(path == "-" ? "standard input" : path), console_(console) {
    if (path == "-") return;
    file_.open(path);
    if (!file_) console_.fail(Failure::bad_input, "cannot read the points", {path, 0, 0});
  }

  /// Replaces `points` by the next ones; false at the end.
  bool next_batch(std::vector<Vec3d>& points) {
    points.clear();
    std::istream& in = file_.is_open() ? static_cast<std::istream&>(file_) : std::cin;
    std::string line;
    while (points.size() < kBatch && std::getline(in, line)) {
      ++line_;
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first == std::string::npos || line[first] == '#') continue;
      points.push_back(parse_point(line));
    }
    if (in.bad()) console_.fail(Failure::bad_input, "cannot read the points", {name_, line_, 0});
    return !points.empty();
  }

 private:
  Vec3d parse_point(const std::string& line) {
    double number[3] = {};
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; };
    for (double& value : number) {
      while (at != end && is_blank(*at)) ++at;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error != std::errc() || !std::isfinite(value) || (stop != end && !is_blank(*stop))) {
        refuse(static_cast<int>(at - line.data()) + 1);
      }
      at = stop;
    }
    while (at != end && is_blank(*at)) ++at;
    if (at != end) refuse(static_cast<int>(at - line.data()) + 1);
    return {number[0], number[1], number[2]};
  }

  [[noreturn]] void refuse(int column) {
    console_.fail(Failure::bad_input, "expected three finite numbers x y z",
                  {name_, line_, column});
  }

  std::string name_;
  Console& console_;
  std::ifstream file_;
  int line_ = 0;
};

const Field& blend_group(const CompiledScene& compiled, const std::string& name,
                         const std::string& scene, Console& console) {
  std::string known;
  for (const Part& part : compiled.parts) {
    const auto* field = dynamic_cast<const Field*>(part.surface.get());
    if (field == nullptr) continue;
    if (part.name == name) return *field;
    known += (known.empty() ? "" : ", ") + part.name;
  }
  console.fail(Failure::bad_input,
               "no blend group '" + name + "' in the scene, " +
                   (known.empty() ? "nothing in it is soft" : "expected one of: " + known),
               {scene, 0, 0});
}

void print_jets(const Field& field, const std::vector<Vec3d>& points) {
  std::vector<Jet> jets(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
    const std::span<const Vec3d> in(points.data() + range.begin(), range.size());
    field.full_jets(in, {jets.data() + range.begin(), range.size()});
  });
  for (const Jet& jet : jets) {
    std::printf("%.17g %.17g %.17g %.17g\n", jet.value, jet.gradient.x, jet.gradient.y,
                jet.gradient.z);
  }
}

void print_inside(const CompiledScene& compiled, const std::vector<Vec3d>& points) {
  std::vector<char> inside(points.size(), 0);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    for (const Part& part : compiled.parts) {
      if (part.surface->value(points[i]) >= 0) inside[i] = 1;
    }
  });
  for (const char flag : inside) std::puts(flag ? "1" : "0");
}

}  // namespace

int run_probe(const Words& arguments) {
  CLI::App app(
      "field value and gradient at points: a line `value gx gy gz` for each line `x y z`; the "
      "value "
      "is F of the blend group, whose surface is F = 1",
      "cs2mesh probe");
  CommonOptions common;
  SceneOptions input;
  std::string points_path;
  std::string group = "soft";
  bool inside = false;
  add_scene_options(app, input);
  app.add_option("points", points_path, "file of points, - for the standard input")
      ->required()
      ->type_name("POINTS");
  app.add_option("--group", group, "blend group (default: the one outside every `blend`)")
      ->type_name("NAME");
  app.add_flag("--inside", inside, "print 1 or 0: inside the union of all parts or not");
  add_common_options(app, common);
  parse(app, arguments);
  Console console(common);
  Stopwatch watch;
  const Scene scene = read_scene(input, console, watch);
  const CompiledScene compiled = console.take(compile(scene));
  const Field* field = inside ? nullptr : &blend_group(compiled, group, scene.file, console);

  PointReader reader(points_path, console);
  std::vector<Vec3d> points;
  while (reader.next_batch(points)) {
    if (inside) {
      print_inside(compiled, points);
    } else {
      print_jets(*field, points);
    }
    console.stop_if_interrupted();
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    console.fail(Failure::output, "cannot write to the standard output");
  }
  return kDone;
}

}  // namespace cs2mesh
