// The colours that the scene language knows by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "libfield/scene/scene.h"

namespace cs2mesh {

/// The colour of an X11 name, or of a POV-Ray name that X11 does not have. Names are written
/// without spaces; the first letter of each word may be in either case (`LightBlue`, `lightblue`,
/// `gray15`), the other letters may not. O(log n).
std::optional<Color> color_of(std::string_view name);

/// All names, as the table writes them.
const std::vector<std::string_view>& color_names();

}  // namespace cs2mesh
