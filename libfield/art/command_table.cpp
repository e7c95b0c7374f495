#include "libfield/art/command_table.h"

#include <algorithm>
#include <string>

#include "libfield/art/commands.h"

namespace cs2mesh {
namespace {

using enum CommandGroup;
using enum CommandEffect;

// The commands of the thesis, C.2, in its order, with those of this project's own at the ends of
// their groups.
constexpr CommandRow kTable[] = {
    {"read", run, "fn1 [fn2 ...]", "reads commands from files, relative to the reading file", acts,
     commands::read},
    {"pause", run, "[message]", "nothing: there is nobody to wait for", noted, nullptr},
    {"return", run, "", "ends the file; what follows in it is not looked at", acts,
     commands::return_},
    {"info", run, "", "nothing: see cs2mesh --version", noted, nullptr},
    {"help", run, "[command]", "nothing: see cs2mesh help", noted, nullptr},
    {"man", run, "command", "nothing: see cs2mesh help", noted, nullptr},
    {"test", run, "command [print]", "nothing: the commands have no built-in test scenes", noted,
     nullptr},
    {"log", run, "[filename]", "nothing: messages go to the standard error stream", noted, nullptr},
    {"var", run, "name = value [hot]", "creates or updates a variable", acts, commands::var},
    {"stopwatch", run, "", "nothing: see the times in --json", noted, nullptr},
    {"quit", run, "", "ends all files; what follows is not looked at", acts, commands::quit},
    {"aperture", camera, "radius", "nothing: the camera is a pinhole", noted, nullptr},
    {"focus", camera, "distance", "nothing: the camera is a pinhole", noted, nullptr},
    {"shutter", camera, "fraction", "nothing: there is no motion", noted, nullptr},
    {"vrp", camera, "x y z", "sets the point that the camera looks at", acts, commands::vrp},
    {"vup", camera, "x y z", "sets the direction up; it becomes +Y in glTF", acts, commands::vup},
    {"cp", camera, "x y z w", "nothing: place the camera by eyep and fov", noted, nullptr},
    {"vpn", camera, "x y z", "nothing: place the camera by eyep and vrp", noted, nullptr},
    {"window", camera, "x X y Y", "nothing: set the view by fov", noted, nullptr},
    {"eyep", camera, "x y z", "sets the position of the eye", acts, commands::eyep},
    {"fov", camera, "hor vert", "sets the field of view in degrees", acts, commands::fov},
    {"texture", materials, "name Target Method [keyword ...]",
     "creates a texture; the target strength makes a profile", acts, commands::texture},
    {"surface", materials, "name [keyword ...]", "creates a surface (a material)", acts,
     commands::surface},
    {"arc", primitives, "sn a b POS NORM start width", "adds a circular arc", acts, commands::arc},
    {"arch", primitives, "sn b P1 P2 P3", "adds the arc from P1 through P2 to P3", acts,
     commands::arch},
    {"box", primitives, "sn PMIN PMAX", "is left out", left_out, nullptr},
    {"brick", primitives, "sn x y z", "is left out", left_out, nullptr},
    {"cone", primitives, "sn b BASE a APEX", "is left out", left_out, nullptr},
    {"cylinder", primitives, "sn r BASE APEX", "adds a cylinder; a soft one is a segment", acts,
     commands::cylinder},
    {"dot", primitives, "sn POS", "adds a soft point with the quartic kernel", acts, commands::dot},
    {"gauss", primitives, "sn POS", "adds a soft point with the Gaussian kernel", acts,
     commands::gauss},
    {"line", primitives, "sn BASE APEX", "adds a soft segment with the Gaussian kernel", acts,
     commands::line},
    {"patch", primitives, "sn V1 N1 V2 N2 V3 N3", "is left out", left_out, nullptr},
    {"pipe", primitives, "sn r BASE APEX", "adds a cylinder, lids included", acts, commands::pipe},
    {"polygon", primitives, "sn V1 ... Vn", "is left out", left_out, nullptr},
    {"plane", primitives, "sn POS NORM", "adds a plane: a slab if soft, a half-space if hard", acts,
     commands::plane},
    {"quadric", primitives, "...", "is left out", left_out, nullptr},
    {"sphere", primitives, "sn r POS", "adds a sphere; a soft one is a point", acts,
     commands::sphere},
    {"terra", primitives, "...", "is left out", left_out, nullptr},
    {"torus", primitives, "sn a b POS NORM", "adds a circle: an arc of 360 degrees", acts,
     commands::torus},
    {"triad", primitives, "sn V1 V2 V3", "is left out", left_out, nullptr},
    {"triangle", primitives, "sn V1 V2 V3", "adds a triangle", acts, commands::triangle},
    {"chain", objects, "sn name", "opens an object of primitives that share a surface", acts,
     commands::chain},
    {"object", objects, "name", "opens a compound object", acts, commands::object},
    {"instance", objects, "old new", "clones an object", acts, commands::instance},
    {"close", objects, "[name]", "closes the innermost object or chain", acts, commands::close},
    {"translate", objects, "x y z [object]", "moves an object or primitive", acts,
     commands::translate},
    {"rotate", objects, "x y z angle [object]",
     "turns an object or primitive, degrees about an axis", acts, commands::rotate},
    {"scale", objects, "x y z [object]", "scales an object or primitive", acts, commands::scale},
    {"explode", objects, "x y z [object]", "is left out: nothing moves", left_out, nullptr},
    {"transform", objects, "[object]", "nothing: transforms always act", noted, nullptr},
    {"blend", objects, "[name]", "makes the open object a blend group of its own, or of that name",
     acts, commands::blend},
    {"echo", options, "on|off", "nothing: commands are not echoed", noted, nullptr},
    {"warning", options, "on|off", "nothing: see --quiet", noted, nullptr},
    {"verbose", options, "on|off", "nothing: see --verbose", noted, nullptr},
    {"bounds", options, "on|off", "nothing: bounding volumes are always used", noted, nullptr},
    {"soft", options, "on|off",
     "chooses soft objects (on) or their offset surfaces (off) for the whole scene", acts,
     commands::soft},
    {"timer", options, "on|off", "nothing: see the times in --json", noted, nullptr},
    {"stat", options, "on|off", "nothing: see --json", noted, nullptr},
    {"map", options, "on|off [N]", "nothing: see cs2mesh render --cost", noted, nullptr},
    {"double", options, "on|off", "nothing: meshes are closed", noted, nullptr},
    {"penumbra", options, "on|off", "nothing: lights are points", noted, nullptr},
    {"noview", options, "on|off", "nothing: no image is displayed", noted, nullptr},
    {"nosave", options, "on|off", "nothing: the command line names the outputs", noted, nullptr},
    {"dither", options, "on|off", "nothing: no image is displayed", noted, nullptr},
    {"gamma", options, "value", "nothing: no image is displayed", noted, nullptr},
    {"framesize", options, "width height", "sets the size of the rendered image in pixels", acts,
     commands::framesize},
    {"filename", options, "name", "nothing: the command line names the outputs", noted, nullptr},
    {"format", options, "fmt", "nothing: the command line names the outputs", noted, nullptr},
    {"compress", options, "on|off", "nothing: the output formats decide", noted, nullptr},
    {"epsilon", options, "value", "nothing: see --tolerance", noted, nullptr},
    {"vanish", options, "value", "nothing: colors are not cut off", noted, nullptr},
    {"maxdepth", options, "number", "nothing: rays do not branch", noted, nullptr},
    {"maxmol", options, "number", "nothing: any number of primitives may meet", noted, nullptr},
    {"digger", options, "hermite|lagrange|brent|ridder|RF",
     "nothing: the command line chooses the ray solver", noted, nullptr},
    {"contrast", options, "r g b", "nothing: see sample", noted, nullptr},
    {"pack", options, "...", "nothing: primitives are always packed", noted, nullptr},
    {"indicator", options, "none|all|bar|text|pixel|line|ETA", "nothing: see --progress", noted,
     nullptr},
    {"fragile", options, "none|all|arc|arch|torus|pipe|cylinder|cone|sphere ...",
     "names the primitives whose own radius yields to the surface's", acts, commands::fragile},
    {"sample", options, "n", "sets up to n x n rays a pixel", acts, commands::sample},
    {"mesh", options, "tolerance d | bounds PMIN PMAX | cell h",
     "sets what --tolerance, --bounds and --cell set", acts, commands::mesh},
    {"light", scene, "Color [point] [position x y z] [intensity k] [noshadow]",
     "adds a point light", acts, commands::light},
    {"fog", scene, "Color [options]", "nothing: there is no atmosphere", noted, nullptr},
    {"background", scene, "Color [options]", "sets the color of the background", acts,
     commands::background},
    {"cloud", scene, "Color [options]", "nothing: there is no atmosphere", noted, nullptr},
    {"remove", scene, "object", "takes an object out of the scene", acts, commands::remove},
    {"report", scene, "...", "nothing: see cs2mesh info", noted, nullptr},
    {"reset", scene, "[subject ...]", "sets all or some of the scene to its beginning", acts,
     commands::reset},
    {"preview", scene, "...", "nothing: see cs2mesh render", noted, nullptr},
    {"shoot", scene, "...", "nothing: the command line says what to make", noted, nullptr},
    {"import", scene, "file sn [edges|faces|points]", "is left out", left_out, nullptr},
    {"animate", tools, "fn1 ... [options]", "nothing: a tool for images", noted, nullptr},
    {"play", tools, "fn [options]", "nothing: a tool for images", noted, nullptr},
    {"split", tools, "fn [frame.fmt]", "nothing: a tool for images", noted, nullptr},
    {"collage", tools, "[options] fn1 fn2", "nothing: a tool for images", noted, nullptr},
    {"fli", tools, "fn1 ... [options]", "nothing: a tool for images", noted, nullptr},
    {"convert", tools, "fn1 fn2", "nothing: a tool for images", noted, nullptr},
    {"resize", tools, "fn x y", "nothing: a tool for images", noted, nullptr},
    {"diff", tools, "fn1 fn2 [save]", "nothing: a tool for images", noted, nullptr},
    {"and", tools, "fn1 fn2 [save]", "nothing: a tool for images", noted, nullptr},
    {"xor", tools, "fn1 fn2 [save]", "nothing: a tool for images", noted, nullptr},
    {"show", tools, "...", "nothing: no window is opened", noted, nullptr},
    {"kill", tools, "[w1 w2 ...]", "nothing: no window is opened", noted, nullptr},
    {"refresh", tools, "[w1 w2 ...]", "nothing: no window is opened", noted, nullptr},
    {"tile", tools, "[options]", "nothing: no window is opened", noted, nullptr},
    {"colors", tools, "", "nothing: the language reference lists the colors", noted, nullptr},
    {"rats", tools, "", "nothing: smalltalk needs two", noted, nullptr},
    {"table", tools, "v1 v2 v3 v4 ...", "nothing: no window is opened", noted, nullptr},
    {"shell", tools, "[options]", "nothing: a generator of data sets", noted, nullptr},
    {"horn", tools, "[options]", "nothing: a generator of data sets", noted, nullptr},
};

}  // namespace

std::string_view name_of(CommandGroup group) {
  constexpr std::string_view kNames[] = {"run",     "camera",  "materials", "primitives",
                                         "objects", "options", "scene",     "tools"};
  return kNames[static_cast<std::size_t>(group)];
}

std::span<const CommandRow> command_table() {
  return kTable;
}

const std::vector<std::string_view>& command_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const CommandRow& row : kTable) all.push_back(row.opcode);
    return all;
  }();
  return names;
}

const CommandRow* find_command(std::string_view opcode) {
  static const std::vector<const CommandRow*> sorted = [] {
    std::vector<const CommandRow*> rows;
    for (const CommandRow& row : kTable) rows.push_back(&row);
    std::sort(rows.begin(), rows.end(),
              [](const CommandRow* a, const CommandRow* b) { return a->opcode < b->opcode; });
    return rows;
  }();
  const auto found = std::lower_bound(
      sorted.begin(), sorted.end(), opcode,
      [](const CommandRow* row, std::string_view name) { return row->opcode < name; });
  return found != sorted.end() && (*found)->opcode == opcode ? *found : nullptr;
}

void execute(const Command& command, const std::string& file, SceneBuilder& builder) {
  const std::string_view opcode = command.opcode.text;
  const CommandRow* const row = find_command(opcode);
  if (!row) {
    // The thesis's text writes `material` where its language has `surface`.
    const std::string hint =
        opcode == "material" ? ", did you mean 'surface'?" : did_you_mean(opcode, command_names());
    builder.log().error(locate(file, command.opcode),
                        "unknown command " + in_quotes(opcode) +
                            ", expected a command of the scene language" + hint);
    return;
  }
  Arguments args(command, file, builder.symbols(), builder.log());
  switch (row->effect) {
    case acts:
      row->handler(builder, args);
      break;
    case noted:
      builder.log().once(Severity::note, opcode, args.opcode_location(),
                         in_quotes(opcode) + " does " + std::string(row->summary));
      break;
    case left_out:
      builder.log().once(Severity::warning, opcode, args.opcode_location(),
                         in_quotes(opcode) + " is not supported, it is left out");
      break;
  }
}

}  // namespace cs2mesh
