// Reproducible random numbers: the n-th number of a stream depends on (seed, n) alone, so parallel
// loops draw the same samples for any number of threads. SplitMix64 (Steele, Lea, Flood 2014).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "libfield/base/vec.h"

namespace cs2mesh {

inline std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(mix64(seed) ^ mix64(~stream)) {}

  std::uint64_t bits() { return mix64(state_++); }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Uniform on the unit sphere.
  Vec3d direction() {
    const double z = uniform(-1.0, 1.0);
    const double azimuth = uniform(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt((1.0 - z) * (1.0 + z));
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace cs2mesh
