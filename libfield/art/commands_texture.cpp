// Textures. Those with the target `strength` act: they are the profiles of the thesis, 3.3.4. The
// others change how a surface looks, not its shape; they are accepted with a note.
#include <array>

#include "libfield/art/colors.h"
#include "libfield/art/commands.h"
#include "libfield/art/texture_list.h"

namespace cs2mesh::commands {
namespace {

constexpr std::array<std::string_view, 10> kTargets = {
    "strength",    "diffuse", "ambient", "specular", "reflective",
    "transparent", "index",   "shine",   "pigment",  "normal"};
constexpr std::size_t kStrength = 0;

enum Keyword : std::size_t {
  kTranslate,
  kScale,
  kTimes,
  kBounds,
  kTexture,
  kTurbulence,
  kOctaves,
  kMask,
  kReplace
};
constexpr std::array<std::string_view, 9> kKeywords = {
    "translate", "scale", "times", "bounds", "texture", "turbulence", "octaves", "mask", "replace"};

void read_bounds(Arguments& args, StrengthProfile& profile) {
  const SourceLocation where = args.here();
  profile.lower = args.rgb("the lower bound, three numbers").x;
  profile.upper = args.rgb("the upper bound, three numbers").x;
  if (!args.failed() && !(profile.lower <= profile.upper)) {
    args.fail(where, "the lower bound exceeds the upper, expected it to be at most that");
  }
}

/// What follows the target `strength`: Fu Fv and keywords.
Texture read_strength(Arguments& args) {
  StrengthProfile profile;
  const std::string_view what = "profile function";
  profile.along_u = static_cast<ProfileFunction>(args.keyword(kProfileNames, what));
  profile.along_v = static_cast<ProfileFunction>(args.keyword(kProfileNames, what));
  Texture texture;
  while (args.more()) {
    const SourceLocation where = args.here();
    const std::size_t keyword = args.keyword(kKeywords, "keyword of a texture");
    if (args.failed()) break;
    switch (keyword) {
      case kTranslate: {
        const Vec3d shift = args.triple("the translation, three numbers");
        profile.translate_u = shift.x;
        profile.translate_v = shift.y;
        break;
      }
      case kScale: {
        const Vec3d factors = args.triple("the scale, three numbers");
        profile.scale_u = factors.x;
        profile.scale_v = factors.y;
        break;
      }
      case kTimes:
        profile.times = args.rgb("the factors, three numbers").x;
        break;
      case kBounds:
        read_bounds(args, profile);
        break;
      case kTexture:
        append_textures(args, texture);
        break;
      default:
        args.fail(where, "a strength profile cannot have " + in_quotes(kKeywords[keyword]) +
                             ", expected translate, scale, times, bounds or texture");
    }
  }
  texture.strength.insert(texture.strength.begin(), profile);
  return texture;
}

/// The right side of `texture new = old`.
Texture read_old(Arguments& args) {
  args.word("'='");
  Texture texture;
  append_textures(args, texture);
  return texture;
}

Texture read_new(SceneBuilder& builder, Arguments& args) {
  Texture texture;
  if (args.take_if("texture", 4)) {
    append_textures(args, texture);
    return texture;
  }
  const std::size_t target = args.keyword(kTargets, "target of a texture");
  if (args.failed()) return texture;
  if (target == kStrength) return read_strength(args);
  if (!args.more()) args.word("how to texture");
  builder.log().once(Severity::note, "texture", args.opcode_location(),
                     "'texture' acts with the target strength only: other textures do not change "
                     "the surface's shape");
  while (args.more()) args.skip();
  return texture;
}

}  // namespace

void texture(SceneBuilder& builder, Arguments& args) {
  const std::string_view name = args.word("the name of a texture");
  Texture texture = args.peek() == "=" ? read_old(args) : read_new(builder, args);
  check_layers(args, texture);
  args.finish();
  // Known even when it is wrong, so that its uses are not reported too.
  NameMap<Texture>& textures = builder.symbols().textures;
  if (!name.empty() && builder.has_room_for_name(args, textures.size())) {
    textures.insert_or_assign(std::string(name), texture);
  }
}

}  // namespace cs2mesh::commands
