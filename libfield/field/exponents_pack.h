// The entries of an ExponentTable over packs of N; see the rules at the head of pack.h.
#pragma once

#include "libfield/field/exponents.h"
#include "libfield/simd/pack.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh::detail {

template <int N>
struct ExponentsPack {
  using T = Pack<N>;
  using Row = ExponentRows::Row;

  static T load(const ExponentRows& rows, Row row, std::size_t place) {
    return T(reinterpret_cast<const typename LaneVectors<N>::Stored*>(rows[row] + place)->lane);
  }
  static Vec3<T> gradient(const ExponentRows& rows, std::size_t place) {
    return {load(rows, Row::gx, place), load(rows, Row::gy, place), load(rows, Row::gz, place)};
  }
  /// The greatest v . d over the box.
  static T along(const Vec3<T>& v, const ExponentBox& box) {
    return abs(v.x) * T(box.half.x) + abs(v.y) * T(box.half.y) + abs(v.z) * T(box.half.z);
  }
  static double sum(const T& lanes) {
    double all = 0.0;
    for (int i = 0; i < N; ++i) all += lanes.lane[i];
    return all;
  }
  static Vec3<T> in_lanes(const Vec3d& v) { return {T(v.x), T(v.y), T(v.z)}; }

  /// The slope of each function relative to its value, at least, times what its ratio to the first
  /// is at least or at most. The ratio's exponent has the gradient g - g_1 and, between any two of
  /// its points, a second derivative between -(most - least_1) and most_1 - least.
  CS2MESH_FLATTEN static SlopeSums slopes(const ExponentRows& rows, const ExponentBox& box,
                                          const Vec3d& direction) {
    const std::size_t f = rows.first;
    const T phi_1(rows[Row::phi][f]), most_1(rows[Row::most][f]), least_1(rows[Row::least][f]);
    const Vec3<T> g_1 = in_lanes({rows[Row::gx][f], rows[Row::gy][f], rows[Row::gz][f]});
    const Vec3<T> d = in_lanes(direction);
    const T length(norm(direction)), half_squared(0.5 * box.radius * box.radius);
    const T across = T(box.radius) * length, straight = along(d, box);
    const T rounding(kExponentRounding), zero(0.0);
    T slope_sum(0.0), weight_sum(0.0), size_sum(0.0);
    for (std::size_t i = 0; i < rows.count; i += N) {
      const T phi = load(rows, Row::phi, i), most = load(rows, Row::most, i);
      const T least = load(rows, Row::least, i);
      const Vec3<T> g = gradient(rows, i);
      // Where both bends are one, the gradient is linear in each coordinate.
      const T turn = most * select(least < most, across, straight);
      const T steepness = abs(g.x) + abs(g.y) + abs(g.z);
      const T slope = dot(g, d) - turn - rounding * (steepness * length + turn);
      const T spread = along(g - g_1, box) + rounding * (abs(phi) + abs(phi_1));
      const T ratio = phi - phi_1;
      const T rise = max(half_squared * (most_1 - least), zero);
      const T fall = max(half_squared * (most - least_1), zero);
      const T high = vmath::exp(ratio + spread + rise);
      const T low = vmath::exp(ratio - spread - fall);
      slope_sum += slope * select(zero < slope, low, high);
      weight_sum += high;
      size_sum += abs(slope) * high;
    }
    return {sum(slope_sum), sum(weight_sum), sum(size_sum)};
  }

  CS2MESH_FLATTEN static WeightSums weights(ExponentRows& rows) {
    const T top(rows[Row::phi][rows.first]);
    T weight_sum(0.0), most_sum(0.0);
    Vec3<T> gradient_sum{T(0.0), T(0.0), T(0.0)};
    for (std::size_t i = 0; i < rows.count; i += N) {
      const T w = vmath::exp(load(rows, Row::phi, i) - top);
      reinterpret_cast<typename LaneVectors<N>::Stored*>(rows[Row::weight] + i)->lane = w.lane;
      weight_sum += w;
      most_sum += w * load(rows, Row::most, i);
      const Vec3<T> g = gradient(rows, i);
      gradient_sum.x += w * g.x;
      gradient_sum.y += w * g.y;
      gradient_sum.z += w * g.z;
    }
    return {sum(weight_sum),
            {sum(gradient_sum.x), sum(gradient_sum.y), sum(gradient_sum.z)},
            sum(most_sum)};
  }

  /// The greatest g t - bend / 2 t^2 for 0 <= t <= half.
  static T highest(const T& g, const T& bend, double half) {
    const T slope = abs(g), h(half);
    const T t = select(slope < bend * h, T(slope / max(bend, T(1e-300))), h);
    return t * (slope - T(0.5) * bend * t);
  }

  /// e^s - 1 - s, from above: the series of it is below that of s^2 / 2 (1 + 0.4 s) for small s.
  static T second_order(const T& s) {
    const T small = T(0.5) * s * s * (T(1) + T(0.4) * s);
    return T(1 + 1e-11) * select(s < T(1e-2), small, T(vmath::exp(s) - T(1) - s));
  }

  CS2MESH_FLATTEN static RiseSums rises(const ExponentRows& rows, const ExponentBox& box,
                                        const Vec3d& mean) {
    const T top(rows[Row::phi][rows.first]);
    const Vec3<T> G = in_lanes(mean);
    T excess(0.0), apart(0.0);
    for (std::size_t i = 0; i < rows.count; i += N) {
      const Vec3<T> g = gradient(rows, i);
      const T least = load(rows, Row::least, i);
      excess += load(rows, Row::weight, i) * second_order(along(g - G, box));
      const T rise = highest(g.x, least, box.half.x) + highest(g.y, least, box.half.y) +
                     highest(g.z, least, box.half.z);
      apart += vmath::exp(load(rows, Row::phi, i) - top + rise);
    }
    return {sum(excess), sum(apart)};
  }

  static consteval ExponentTable table() { return {&slopes, &weights, &rises}; }
};

}  // namespace cs2mesh::detail
