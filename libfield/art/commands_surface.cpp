// Surfaces, which the thesis's text calls materials.
#include <array>
#include <utility>

#include "libfield/art/commands.h"
#include "libfield/art/texture_list.h"

namespace cs2mesh::commands {
namespace {

enum Keyword : std::size_t {
  kBody,
  kAmbient,
  kDiffuse,
  kSpecular,
  kReflective,
  kTransparent,
  kIndex,
  kDispersion,
  kShine,
  kRadius,
  kBlobbiness,
  kStrength,
  kSkip,
  kTexture,
  kKernel,
  kWidth
};
constexpr std::array<std::string_view, 16> kKeywords = {
    "body",  "ambient",    "diffuse", "specular", "reflective", "transparent",
    "index", "dispersion", "shine",   "radius",   "blobbiness", "strength",
    "skip",  "texture",    "kernel",  "width"};

constexpr std::array<std::string_view, 9> kKernelNames = {"cauchy",  "gaussian",   "inverse",
                                                          "squared", "metaball",   "soft",
                                                          "quartic", "invsquared", "metaballs"};

constexpr std::array<std::string_view, 4> kRayTypes = {"pixel", "shadow", "reflected",
                                                       "transmitted"};

/// A surface's colours before percentages of the body's colour are known.
struct Colors {
  std::optional<Color> body;
  std::optional<ColorArgument> diffuse, ambient;
};

Color scaled(double k, const Color& c) {
  return {k * c.r, k * c.g, k * c.b};
}

/// Percentages of diffuse and ambient colour are of the body's, those of the others of white.
Color resolve(const ColorArgument& argument, const Color& whole) {
  return argument.is_percentage ? scaled(argument.share, whole) : argument.color;
}

void resolve_colors(const Colors& colors, Material& material) {
  const Color body = colors.body.value_or(Color{1, 1, 1});
  material.diffuse = colors.diffuse ? resolve(*colors.diffuse, body) : body;
  if (colors.ambient) material.ambient = resolve(*colors.ambient, body);
}

double negative(Arguments& args, std::string_view what) {
  const SourceLocation where = args.here();
  const std::string_view word = args.peek();
  const double value = args.number(what);
  if (!args.failed() && !(value < 0)) {
    args.fail(where, in_quotes(word) + " is out of range, expected " + std::string(what) + " < 0");
  }
  return value;
}

KernelKind read_kernel(Arguments& args) {
  const std::string_view word = args.peek();
  // "meta" is short for two words that mean the same.
  if (!word.empty() && std::string_view("metaball").starts_with(word)) {
    args.skip();
    return KernelKind::metaball;
  }
  const std::size_t index = args.keyword(kKernelNames, "kernel");
  return kernel_of(kKernelNames[index]).value_or(KernelKind::cauchy);
}

/// One or more ray types; a word that is also the beginning of a keyword ends them.
void read_skip(Arguments& args) {
  args.keyword(kRayTypes, "type of ray");
  while (args.more()) {
    const std::string_view word = args.peek();
    bool known = false;
    for (const std::string_view type : kRayTypes) known = known || type == word;
    if (!known) return;
    args.skip();
  }
}

void read_keyword(Arguments& args, Colors& colors, Material& material) {
  const std::size_t keyword = args.keyword(kKeywords, "keyword of a surface");
  if (args.failed()) return;
  constexpr std::string_view kColor = "a color";
  switch (keyword) {
    case kBody:
      colors.body = args.color(kColor);
      break;
    case kAmbient:
      colors.ambient = args.color_or_percentage(kColor);
      break;
    case kDiffuse:
      colors.diffuse = args.color_or_percentage(kColor);
      break;
    case kSpecular:
      material.specular = resolve(args.color_or_percentage(kColor), {1, 1, 1});
      break;
    case kReflective:
    case kTransparent:
      args.color_or_percentage(kColor);
      break;
    case kIndex:
      args.positive("the index of refraction");
      break;
    case kDispersion:
      args.number("the dispersion");
      break;
    case kShine:
      material.shine = args.not_negative("the shine");
      break;
    case kRadius:
      material.radius = args.positive("the radius in isolation");
      break;
    case kBlobbiness:
      material.blobbiness = negative(args, "the blobbiness");
      break;
    case kStrength:
      material.strength = args.number("the strength");
      break;
    case kSkip:
      read_skip(args);
      break;
    case kTexture: {
      Texture texture{material.profiles};
      append_textures(args, texture);
      material.profiles = std::move(texture.strength);
      break;
    }
    case kKernel:
      material.kernel = read_kernel(args);
      break;
    case kWidth:
      material.width = args.positive("the width of the kernel");
      break;
    default:
      break;
  }
}

Material read_new(Arguments& args) {
  Material material;
  Colors colors;
  while (args.more()) read_keyword(args, colors, material);
  resolve_colors(colors, material);
  return material;
}

}  // namespace

void surface(SceneBuilder& builder, Arguments& args) {
  const SourceLocation where = args.opcode_location();
  const std::string_view name = args.word("the name of a surface");
  if (name.empty()) return;
  std::vector<Material>& materials = builder.scene().materials;
  if (!builder.has_room_for_name(args, materials.size())) return;
  Material material;
  if (args.peek() == "=") {
    args.skip();
    const int old = builder.material_named(args);
    if (args.finish()) material = materials[static_cast<std::size_t>(old)];
  } else {
    material = read_new(args);
    args.finish();
  }
  material.name = name;
  material.where = where;
  // Known even when it is wrong, so that its uses are not reported too.
  builder.symbols().surfaces.insert_or_assign(std::string(name),
                                              MaterialIndex{static_cast<int>(materials.size())});
  materials.push_back(std::move(material));
}

}  // namespace cs2mesh::commands
