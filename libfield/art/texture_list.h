// `t1 + t2 + ...`: the layers of textures that a surface or a texture is given.
#pragma once

#include "libfield/art/arguments.h"

namespace cs2mesh {

/// Most layers of one texture or surface (thesis C.2, restrictions).
inline constexpr std::size_t kMaxTextureLayers = 12;

/// Reads names joined by `+`, with or without white space around it, and appends their layers.
void append_textures(Arguments& args, Texture& texture);

/// Fails if there are more layers than kMaxTextureLayers.
void check_layers(Arguments& args, const Texture& texture);

}  // namespace cs2mesh
