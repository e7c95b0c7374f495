// The skeleton primitives. To add one: its file, and its place in this list.
#pragma once

#include <string_view>
#include <variant>

#include "libfield/primitive/arc.h"
#include "libfield/primitive/plane.h"
#include "libfield/primitive/point.h"
#include "libfield/primitive/segment.h"
#include "libfield/primitive/tapered_segment.h"
#include "libfield/primitive/triangle.h"

namespace cs2mesh {

using Primitive = std::variant<Point, Segment, Arc, Triangle, Plane, TaperedSegment>;

}  // namespace cs2mesh
