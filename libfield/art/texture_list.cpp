#include "libfield/art/texture_list.h"

namespace cs2mesh {
namespace {

const Texture* texture_named(const Symbols& symbols, std::string_view name) {
  if (const Texture* texture = find(symbols.textures, name)) return texture;
  const Value* value = find(symbols.variables, name);
  return value ? std::get_if<Texture>(value) : nullptr;
}

void append(Arguments& args, const SourceLocation& where, std::string_view name, Texture& texture) {
  const Texture* const layers = texture_named(args.symbols(), name);
  if (!layers) {
    args.fail(where, "unknown texture " + in_quotes(name) + ", expected the name of a texture" +
                         did_you_mean(name, names_of(args.symbols().textures)));
    return;
  }
  texture.strength.insert(texture.strength.end(), layers->strength.begin(), layers->strength.end());
  check_layers(args, texture);
}

}  // namespace

void append_textures(Arguments& args, Texture& texture) {
  bool expects_name = true;
  while (!args.failed() && (expects_name || args.peek().starts_with('+'))) {
    const SourceLocation where = args.here();
    std::string_view word = args.word("the name of a texture");
    if (args.failed()) return;
    if (texture_named(args.symbols(), word)) {
      append(args, where, word, texture);
      expects_name = false;
      continue;
    }
    // Split at each '+'.
    while (!word.empty() && !args.failed()) {
      if (word.front() == '+') {
        if (expects_name) {
          args.fail(where, "found '+', expected the name of a texture");
          return;
        }
        expects_name = true;
        word.remove_prefix(1);
        continue;
      }
      const std::string_view name = word.substr(0, word.find('+'));
      append(args, where, name, texture);
      expects_name = false;
      word.remove_prefix(name.size());
    }
  }
}

void check_layers(Arguments& args, const Texture& texture) {
  if (args.failed() || texture.strength.size() <= kMaxTextureLayers) return;
  args.fail(args.opcode_location(),
            "too many layers of textures, expected at most " + std::to_string(kMaxTextureLayers));
}

}  // namespace cs2mesh
