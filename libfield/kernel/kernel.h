// The kernels. To add one: its file, its name in kind.h, its place in this list and in make_kernel.
#pragma once

#include <variant>

#include "libfield/base/check.h"
#include "libfield/kernel/cauchy.h"
#include "libfield/kernel/gaussian.h"
#include "libfield/kernel/inverse.h"
#include "libfield/kernel/metaball.h"
#include "libfield/kernel/quartic.h"
#include "libfield/kernel/soft.h"
#include "libfield/kernel/squared.h"

namespace cs2mesh {

using Kernel = std::variant<Cauchy, Gaussian, Inverse, Squared, Metaball, Soft, Quartic>;

/// The kernel of that kind. `width` is s, a or the support radius (ignored for the inverse
/// kernels); the Gaussian takes its amplitude as `log_strength`, all others as `strength` > 0;
/// `clamp` matters to the inverse kernels alone.
inline Kernel make_kernel(KernelKind kind, double width, double strength, double log_strength,
                          double clamp) {
  switch (kind) {
    case KernelKind::cauchy:
      return Cauchy{width, strength};
    case KernelKind::gaussian:
      return Gaussian{width, log_strength};
    case KernelKind::inverse:
      return Inverse{strength, clamp};
    case KernelKind::squared:
      return Squared{strength, clamp};
    case KernelKind::metaball:
      return Metaball{width, strength};
    case KernelKind::soft:
      return Soft{width, strength};
    case KernelKind::quartic:
      return Quartic{width, strength};
  }
  require(false, "unknown kernel");
  return Cauchy{1.0};
}

}  // namespace cs2mesh
