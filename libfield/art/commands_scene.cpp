// Lights, background, and starting over.
#include <array>

#include "libfield/art/commands.h"

namespace cs2mesh::commands {
namespace {

/// Memory stays bounded however many `light` lines there are.
constexpr std::size_t kMaxLights = 10'000;

/// The subjects of `reset`, in the thesis's order.
enum Subject : std::size_t {
  kAll,
  kData,
  kModel,
  kSurfaces,
  kTextures,
  kLights,
  kBackground,
  kClouds,
  kFog,
  kCameras,
  kOptions,
  kVar
};
constexpr std::array<std::string_view, 12> kSubjects = {
    "all",        "data",   "model", "surfaces", "textures", "lights",
    "background", "clouds", "fog",   "cameras",  "options",  "var"};

void reset_subject(SceneBuilder& builder, std::size_t subject) {
  Scene& scene = builder.scene();
  const auto is = [subject](std::size_t s) { return subject == kAll || subject == s; };
  if (is(kModel) || is(kData)) builder.clear_model();
  if (is(kSurfaces) || is(kData)) builder.symbols().surfaces.clear();
  if (is(kTextures) || is(kData)) builder.symbols().textures.clear();
  if (is(kLights)) scene.lights.clear();
  if (is(kBackground)) scene.background = {};
  if (is(kCameras)) scene.camera = {};
  if (is(kOptions)) {
    scene.soft = true;
    scene.fragile = {};
    scene.mesh = {};
  }
  if (is(kVar)) builder.clear_variables();
}

}  // namespace

void light(SceneBuilder& builder, Arguments& args) {
  constexpr std::array<std::string_view, 5> kKeywords = {"point", "position", "intensity",
                                                         "noshadow", "shadow"};
  Light light;
  light.color = args.color("the color of the light");
  while (args.more()) {
    const std::size_t keyword = args.keyword(kKeywords, "option of a light");
    if (args.failed()) return;
    if (keyword == 1) light.position = args.triple("the position, x y z");
    if (keyword == 2) light.intensity = args.number("the intensity");
    if (keyword == 3) light.shadow = false;
    if (keyword == 4) light.shadow = true;
  }
  if (builder.scene().lights.size() >= kMaxLights) {
    args.fail(args.opcode_location(),
              "too many lights, expected at most " + std::to_string(kMaxLights), Failure::limit);
  }
  if (args.finish()) builder.scene().lights.push_back(light);
}

void background(SceneBuilder& builder, Arguments& args) {
  const Color color = args.color("the color of the background");
  if (args.more()) {
    builder.log().once(Severity::note, "background options", args.here(),
                       "the options of 'background' do nothing here");
    while (args.more()) args.skip();
  }
  if (args.finish()) builder.scene().background = color;
}

void reset(SceneBuilder& builder, Arguments& args) {
  if (builder.in_object()) {
    args.fail(args.opcode_location(), "'reset' inside of an object, expected 'close' before it");
    return;
  }
  if (!args.more()) {
    reset_subject(builder, kAll);
    return;
  }
  while (args.more()) {
    const std::size_t subject = args.keyword(kSubjects, "subject of 'reset'");
    if (!args.failed()) reset_subject(builder, subject);
  }
}

}  // namespace cs2mesh::commands
