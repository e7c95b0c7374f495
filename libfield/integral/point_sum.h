// The fields of many points at many places, for every kernel: the innermost loop of scenes of
// blobs. Each lane of a pack holds one place and runs through the sources in their order, so that
// a source costs three subtractions, its law, and one fused step a sum; see bulk.h for who calls.
//
// Legend: u = r^2; h the kernel, m = 2 dh/du, so that the gradient is m d with d = p - q. The
// constants of a source are folded once (s^2, a^2 / ln 2, 1 / R^2 ...), and where the machine has
// fused multiply-add it is used: results agree with integral(kernel, Point, p) within a few ulp of
// inputs moved by as much, and differ in their last bits between machines with and without it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "libfield/base/vec.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/point.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

/// One point with a kernel, its constants folded: a cache line.
struct alignas(64) PointSource {
  Vec3d position;
  double rate = 0.0;   ///< what u is multiplied by; for the inverse kernels the least u
  double gain = 0.0;   ///< the factor of h; for the Gaussian a part of its exponent
  double slope = 0.0;  ///< the factor of m
  double sign = 1.0;
};

/// How h and m of a kernel follow from u and the constants of a source.
template <class K>
struct PointLaw;

/// h and m.
template <class T>
struct PointFall {
  T h, m;
};

template <>
struct PointLaw<Cauchy> {
  static PointSource fold(const Cauchy& k, const Vec3d& at, double sign) {
    const double s2 = k.s * k.s, gain = sign * k.amplitude;
    return {at, s2, gain, -4.0 * s2 * gain, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    const T w = T(1) / fma(u, T(source.rate), T(1));
    const T w2 = w * w;
    return {T(source.gain) * w2, T(source.slope) * (w2 * w)};
  }
};

template <>
struct PointLaw<Gaussian> {
  /// In exponents of 2, where the power taken out leaves the rest exact.
  static constexpr double kGreatest = Gaussian::kGreatestExponent * std::numbers::log2e;
  static constexpr double kLeast = -1020.0;

  static PointSource fold(const Gaussian& k, const Vec3d& at, double sign) {
    const double a2 = k.a * k.a;
    return {at, a2 * std::numbers::log2e, k.log_amplitude * std::numbers::log2e, -2.0 * a2 * sign,
            sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    using std::max;
    using std::min;
    const T exponent = max(min(fma(u, T(-source.rate), T(source.gain)), T(kGreatest)), T(kLeast));
    const T power = vmath::exp2(exponent);
    return {T(source.sign) * power, T(source.slope) * power};
  }
};

template <>
struct PointLaw<Inverse> {
  static PointSource fold(const Inverse& k, const Vec3d& at, double sign) {
    return {at, k.clamp * k.clamp, sign * k.amplitude, -sign * k.amplitude, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    using std::max;
    using std::sqrt;
    const T least(source.rate);
    const T w = T(1) / sqrt(max(u, least));
    return {T(source.gain) * w, select(u < least, T(0), T(T(source.slope) * (w * w * w)))};
  }
};

template <>
struct PointLaw<Squared> {
  static PointSource fold(const Squared& k, const Vec3d& at, double sign) {
    return {at, k.clamp * k.clamp, sign * k.amplitude, -2.0 * sign * k.amplitude, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    using std::max;
    const T least(source.rate);
    const T w = T(1) / max(u, least);
    return {T(source.gain) * w, select(u < least, T(0), T(T(source.slope) * (w * w)))};
  }
};

/// v = (1 - u / R^2)_+; 0 from the support on.
template <class T>
T support_height(const PointSource& source, const T& u) {
  using std::max;
  return max(fma(u, T(-source.rate), T(1)), T(0));
}

template <>
struct PointLaw<Metaball> {
  static PointSource fold(const Metaball& k, const Vec3d& at, double sign) {
    const double rate = 1.0 / (k.radius * k.radius), gain = sign * k.amplitude;
    return {at, rate, gain, -3.0 * gain * rate, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    using std::max;
    using std::sqrt;
    const T y2 = u * T(source.rate);
    // Within R / 3 nothing depends on y itself, which may be 0 there.
    const auto inner = T(9) * y2 <= T(1);
    const T y = sqrt(max(y2, T(0.1)));
    const T rest = max(T(1) - y, T(0));
    const T h = select(inner, T(fma(y2, T(-3), T(1))), T(T(1.5) * rest * rest));
    const T m = select(inner, T(2), T(rest / y));
    return {T(source.gain) * h, T(source.slope) * m};
  }
};

template <>
struct PointLaw<Soft> {
  static PointSource fold(const Soft& k, const Vec3d& at, double sign) {
    const double rate = 1.0 / (k.radius * k.radius), gain = sign * k.amplitude / 9.0;
    return {at, rate, gain, -2.0 * gain * rate, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    const T v = support_height(source, u);
    const T gain = T(source.gain) * v, slope = T(source.slope) * v;
    return {gain * v * fma(v, T(4), T(5)), slope * fma(v, T(12), T(10))};
  }
};

template <>
struct PointLaw<Quartic> {
  static PointSource fold(const Quartic& k, const Vec3d& at, double sign) {
    const double rate = 1.0 / (k.radius * k.radius), gain = sign * k.amplitude;
    return {at, rate, gain, -4.0 * gain * rate, sign};
  }
  template <class T>
  static PointFall<T> fall(const PointSource& source, const T& u) {
    const T v = support_height(source, u);
    return {T(source.gain) * (v * v), T(source.slope) * v};
  }
};

/// A place as seen from a source.
template <class T>
struct PointPlace {
  T x, y, z, u;

  PointPlace(const PointSource& source, const Vec3<T>& p)
      : x(p.x - T(source.position.x)),
        y(p.y - T(source.position.y)),
        z(p.z - T(source.position.z)),
        u(fma(x, x, fma(y, y, T(z * z)))) {}

  void add_to(JetOf<T>& sum, const PointFall<T>& at) const {
    sum.value += at.h;
    sum.gradient = {fma(at.m, x, sum.gradient.x), fma(at.m, y, sum.gradient.y),
                    fma(at.m, z, sum.gradient.z)};
  }
};

/// The sum of value and gradient at p over the sources[index[i]], i < count.
template <class K, class T>
JetOf<T> point_sum(const PointSource* sources, const std::uint32_t* index, std::size_t count,
                   const Vec3<T>& p) {
  JetOf<T> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    const PointSource& source = sources[index[i]];
    const PointPlace<T> at(source, p);
    at.add_to(sum, PointLaw<K>::fall(source, at.u));
  }
  return sum;
}

/// Adds point_sum() at each of the points; where `Out` is double, the value alone.
template <class Out>
using AddPoints = void (*)(const PointSource* sources, const std::uint32_t* index,
                           std::size_t source_count, const Vec3d* points, Out* sums,
                           std::size_t count);

/// By KernelKind.
template <class Out>
using PointRow = std::array<AddPoints<Out>, kAllKernels.size()>;

/// The source of a point, its kernel's amplitude times `sign`.
inline PointSource point_source(const Kernel& kernel, const Point& point, double sign) {
  return std::visit(
      [&](const auto& k) {
        return PointLaw<std::decay_t<decltype(k)>>::fold(k, point.position, sign);
      },
      kernel);
}

}  // namespace cs2mesh
