// Kernels over the whole plane: with d the signed distance and n the unit normal,
//     f(p) = 2 pi int_0^inf h(sqrt(d^2 + rho^2)) rho d rho = pi int_{d^2}^inf h du,
//     grad f = -2 pi d h(|d|) n.
// Closed forms for every kernel but the inverse ones, whose integrals diverge:
//     Cauchy pi A / (s^2 (1 + s^2 d^2)); Gaussian (pi / a^2) exp(log A - a^2 d^2);
//     quartic pi R^2 A w^3 / 3; soft pi R^2 A w^3 (5/27 + w/9); w = 1 - d^2 / R^2;
//     metaballs A ((3/2) m(R) - (1/2) m(R/3)), m(q) = (pi q^2 / 6) (1 - |d|/q)_+^3 (1 + 3 |d|/q).
// Accurate to a few ulp for a p moved by a few ulp. Finite for every finite p.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/plane.h"

namespace cs2mesh {

namespace detail {

template <class T>
T pi_of() {
  if constexpr (kIsDouble<T>) {
    return T(std::numbers::pi);
  } else {
    using std::acos;
    return acos(T(-1));
  }
}

template <class T>
T plane_value(const Cauchy& k, const T& d) {
  const T s2 = T(k.s) * T(k.s);
  return pi_of<T>() * T(k.amplitude) / (s2 * (T(1) + s2 * d * d));
}

template <class T>
T plane_value(const Gaussian& k, const T& d) {
  return pi_of<T>() / (T(k.a) * T(k.a)) * k.profile(T(d * d));
}

/// 1 - d^2 / R^2 as a product, 0 beyond the support.
template <class T>
T plane_height(double support, const T& d) {
  using std::abs;
  const T x = abs(d) / T(support);
  return select(x < T(1), T((T(1) - x) * (T(1) + x)), T(0));
}

template <class T>
T plane_value(const Quartic& k, const T& d) {
  const T w = plane_height(k.radius, d);
  return pi_of<T>() * T(k.radius) * T(k.radius) * T(k.amplitude) * w * w * w / T(3);
}

template <class T>
T plane_value(const Soft& k, const T& d) {
  const T w = plane_height(k.radius, d);
  return pi_of<T>() * T(k.radius) * T(k.radius) * T(k.amplitude) * w * w * w * (T(5) + T(3) * w) /
         T(27);
}

template <class T>
T plane_value(const Metaball& k, const T& d) {
  using std::abs;
  const auto cone = [&](const T& reach) {
    const T x = abs(d) / reach;
    const T m = T(1) - x;
    return select(x < T(1), T(reach * reach * m * m * m * (T(1) + T(3) * x) / T(6)), T(0));
  };
  const T reach(k.radius);
  return pi_of<T>() * T(k.amplitude) * (T(3) * cone(reach) - cone(T(reach / T(3)))) / T(2);
}

// Greatest size over z >= d of z h (order 1) and of its first, second and third derivative (orders
// 2, 3, 4). d(z h)/dz = h + 2 z^2 K. Kernels of finite support begin like (1 - z / R)^2, so the
// second derivative of z h jumps at the edge (for metaballs also at R / 3) and the third has no
// bound up to there.

inline double plane_slope_bound(const Cauchy& k, int order, double d) {
  const double x = std::min(k.s * d * (k.s * d), 1e60);  // powers of it stay finite
  const auto cubed = [](double q) { return q * q * q; };
  if (order == 1) {
    const double peaked = std::max(x, 1.0 / 3.0);
    return k.amplitude * std::sqrt(peaked) / (k.s * (1.0 + peaked) * (1.0 + peaked));
  }
  // In units of 1 / s: -12 z (1 - x) q^-4, then -12 (1 - 10 x + 5 x^2) q^-5, then
  // 120 z (3 - 10 x + 3 x^2) q^-6.
  if (order == 3) {
    static constexpr double kPeaks[] = {0.105572809000, 1.894427191000};
    return 12.0 * k.amplitude * k.s * greatest_from(x, kPeaks, [&](double at) {
             return std::sqrt(at) * std::abs(1.0 - at) / (cubed(1.0 + at) * (1.0 + at));
           });
  }
  if (order == 4) {
    static constexpr double kPeaks[] = {1.0 / 3.0, 3.0};
    return 12.0 * k.amplitude * k.s * k.s * greatest_from(x, kPeaks, [&](double at) {
             const double w = 1.0 / (1.0 + at);
             return std::abs(w * w - (10.0 - 5.0 * at) * (w * at) * w) * cubed(w);
           });
  }
  const double peaked = std::max(x, 1.0);
  const double falling = (1.0 - 3.0 * x) / cubed(1.0 + x);
  return k.amplitude * std::max(falling, (3.0 * peaked - 1.0) / cubed(1.0 + peaked));
}

inline double plane_slope_bound(const Gaussian& k, int order, double d) {
  const double x = std::min(k.a * d * (k.a * d), 1e15);  // exp(-x) is 0 long before
  const double cut = k.log_amplitude - Gaussian::kGreatestExponent;
  const auto h = [&](double at) { return k.derivative_envelope(0, std::sqrt(at) / k.a); };
  if (order == 1) {
    const double peaked = std::max({x, 0.5, cut});
    return std::sqrt(peaked) / k.a * h(peaked);
  }
  // z h is -h' / (2 a^2): its derivatives along the normal are those of the kernel along a ray.
  if (order > 2) return 0.5 / (k.a * k.a) * k.derivative_envelope(order, d);
  const double peaked = std::max({x, 1.5, cut});
  return std::max(std::max(0.0, 1.0 - 2.0 * x) * h(x), (2.0 * peaked - 1.0) * h(peaked));
}

inline double plane_slope_bound(const Quartic& k, int order, double d) {
  if (d > k.radius) return 0.0;
  if (order == 3) return 8.0 * k.amplitude / k.radius;  // 20 y^3 - 12 y at the edge
  if (order == 4) return std::numeric_limits<double>::infinity();
  const double v = plane_height(k.radius, d) + 8e-16;
  if (order == 1) {
    const double w = std::min(v, 0.8);  // y v^2 peaks at y^2 = 1/5
    return k.amplitude * k.radius * std::sqrt(1.0 - w) * w * w;
  }
  const double w = std::min(v, 0.4);
  return k.amplitude * std::max(v * (5.0 * v - 4.0), w * (4.0 - 5.0 * w));
}

inline double plane_slope_bound(const Soft& k, int order, double d) {
  if (d > k.radius) return 0.0;
  // -2 y (84 v^2 + 2 v - 20) / 9 is greatest at the edge; where 210 v^2 - 165 v - 12 = 0 it is 3.7.
  if (order == 3) return 40.0 / 9.0 * k.amplitude / k.radius;
  if (order == 4) return std::numeric_limits<double>::infinity();
  const double v = plane_height(k.radius, d) + 8e-16;
  if (order == 1) {
    static const double v_peak = (std::sqrt(2241.0) - 1.0) / 56.0;  // root of 28 v^2 + v - 20
    const double w = std::min(v, v_peak);
    return k.amplitude * k.radius * std::sqrt(1.0 - w) * w * w * (5.0 + 4.0 * w) / 9.0;
  }
  const auto slope = [](double w) { return w * (w * (28.0 * w + 1.0) - 20.0) / 9.0; };
  return k.amplitude * std::max(slope(v), -slope(std::min(v, 10.0 / 21.0)));
}

inline double plane_slope_bound(const Metaball& k, int order, double d) {
  if (d > k.radius) return 0.0;
  const double y = d / k.radius;
  // -18 y up to R / 3, then 9 y - 6.
  if (order == 3) return (y < 1.0 / 3.0 + 1e-15 ? 6.0 : 3.0) * k.amplitude / k.radius;
  if (order == 4) return std::numeric_limits<double>::infinity();
  if (order == 1) {
    const double peaked = std::max(y, 1.0 / 3.0);
    const double m = std::max(0.0, 1.0 - peaked) + 4e-16;
    return k.amplitude * k.radius * peaked * 1.5 * m * m;
  }
  const double peaked = std::max(y, 2.0 / 3.0);
  const double m = std::max(0.0, 1.0 - peaked) + 4e-16;
  return k.amplitude * std::max(1.0 - 9.0 * y * y, 1.5 * m * (3.0 * peaked - 1.0));
}

}  // namespace detail

/// Value and gradient of the field of a plane; not declared for Inverse and Squared.
template <class K, class T>
requires requires(const K& k, const T& d) {
  detail::plane_value(k, d);
}
JetOf<T> integral(const K& kernel, const Plane& plane, const Vec3<T>& p) {
  const Vec3<T> n(plane.normal);
  const T d = dot(p - Vec3<T>(plane.point), n);
  return {detail::plane_value(kernel, d),
          T(-2) * detail::pi_of<T>() * d * kernel.profile(T(d * d)) * n};
}

}  // namespace cs2mesh
