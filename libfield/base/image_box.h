// The box around the image of a box.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"

namespace cs2mesh {

/// The smallest box around the image of a finite box.
inline Aabb image_box(const Aabb& box, const Affine& map) {
  Aabb image;
  for (int corner = 0; corner < 8; ++corner) image.include(map(box.corner(corner)));
  return image;
}

}  // namespace cs2mesh
