// Scene -> .art text.
#pragma once

#include <string>

#include "libfield/scene/scene.h"

namespace cs2mesh {

/// The scene as text that parse_art reads back to the same scene: the same elements and objects in
/// the same order with the same materials. Numbers are exact; what is stored in another form than
/// the language writes (transforms, arcs) returns to a few ulp. Surfaces whose names recur get a
/// number. Each element's skeleton must be of its command's kind, with an own radius where the
/// command has one; objects must precede those below them.
std::string print_art(const Scene& scene);

}  // namespace cs2mesh
