// Where the second derivative of a kernel jumps.
//
// Hess h = 2K I + 4K' d d^T with K continuous: at such a distance it jumps by a multiple of n n^T,
// n the direction from the source.
#pragma once

namespace cs2mesh {

struct Kink {
  double radius;  ///< distance from the source
  double jump;    ///< of the second derivative along the ray, in absolute value
};

/// Whether a kernel has kinks, and then `piece_envelope(r)`, an upper bound of the norm of the
/// third derivative over all distances >= r but for the kinks, non-increasing in r.
template <class K>
inline constexpr bool kHasKinks = requires(const K& k) {
  k.kinks();
};

/// The kernel as its smooth pieces: what derivative_bound() needs, for order 3.
template <class K>
struct SmoothPieces {
  const K& kernel;
  double derivative_envelope(int /*order*/, double r) const { return kernel.piece_envelope(r); }
  double support() const { return kernel.support(); }
  double length_scale() const { return kernel.length_scale(); }
};

}  // namespace cs2mesh
