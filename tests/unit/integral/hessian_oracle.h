// Second derivatives of fields in extended precision: the differentiated kernel, integrated over
// segments, arcs and triangles by adaptive quadrature that knows nothing of the kernel but the
// radii where its derivatives jump.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "libfield/base/jet2.h"
#include "libfield/integral/quadrature.h"

namespace cs2mesh::hessian_oracle {

using Real = long double;
using Matrix = SymmetricOf<Real>;
using Vector = Vec3<Real>;

/// A matrix and the sum of the norms of what it is made of.
struct Sum {
  Matrix matrix;
  Real size = 0;

  Sum& operator+=(const Sum& other) {
    matrix += other.matrix;
    size += other.size;
    return *this;
  }
  friend Sum operator*(Real k, const Sum& sum) { return {k * sum.matrix, std::abs(k) * sum.size}; }
};

/// 2K I + 4K' d d^T.
template <class K>
Sum integrand(const K& kernel, const Vector& d) {
  const Real u = squared_norm(d);
  const Real k2 = 2 * kernel.slope(u);
  const Real k4 = 4 * kernel.curvature(u);
  return {multiple_of_unit(k2) + k4 * squared(d), std::abs(k2) + std::abs(k4) * u};
}

template <unsigned N, class F>
Sum by_nodes(const F& f, Real a, Real length) {
  using Rule = boost::math::quadrature::gauss<Real, N>;
  Sum sum;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i) {
    const Real half = length / 2, x = Rule::abscissa()[i], w = half * Rule::weights()[i];
    sum += w * f(a + half * (1 - x));
    sum += w * f(a + half * (1 + x));
  }
  return sum;
}

/// Halves [a, a + length] until 20 nodes change what 14 give by less than `allowed`.
template <class F>
Sum halved(const F& f, Real a, Real length, Real allowed, int depth) {
  const Sum sum = by_nodes<20>(f, a, length);
  const Real change = norm(Matrix(sum.matrix - by_nodes<14>(f, a, length).matrix));
  if (depth == 0 || !(change > allowed)) return sum;
  Sum both = halved(f, a, length / 2, allowed, depth - 1);
  both += halved(f, a + length / 2, length / 2, allowed, depth - 1);
  return both;
}

/// Appends places that close in on `peak`, down to `least` from it, lest nodes jump over it.
inline void close_in(Real peak, Real length, Real least, std::vector<Real>& cuts) {
  cuts.push_back(peak);
  for (Real step = length / 8; step > least / 4; step /= 8) {
    cuts.push_back(peak - step), cuts.push_back(peak + step);
  }
}

/// How far a kernel seen from that distance keeps its size.
template <class K>
Real reach_of(const K& kernel, Real distance) {
  const Real width = kernel.length_scale();
  if constexpr (std::is_same_v<K, Cauchy>) return std::hypot(width, distance) / 4;
  return width > 0 ? width * std::min<Real>(1, width / distance) : distance / 4;
}

/// To that part of the whole: less than rounding makes of places at `scale`.
inline Real tolerance_for(Real scale, Real reach) {
  return 1e-17L + 1e-19L * scale / reach;
}

/// int f over 0 <= t <= length, in parts between the cuts.
template <class F>
Sum integral_over(const F& f, Real length, std::vector<Real> cuts, Real tolerance) {
  cuts.push_back(0), cuts.push_back(length);
  std::sort(cuts.begin(), cuts.end());
  const auto visit = [&](const auto& take) {
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      const Real a = std::clamp<Real>(cuts[i], 0, length);
      const Real b = std::clamp<Real>(cuts[i + 1], 0, length);
      // x = s^2 (3 - 2s) turns square roots at either end into smooth functions.
      if (b > a) {
        take([&, a, b](Real s) {
          return 6 * s * (1 - s) * (b - a) * f(a + (b - a) * (s * s * (3 - 2 * s)));
        });
      }
    }
  };
  Real total = 0;
  visit([&](const auto& part) { total += by_nodes<7>(part, 0, 1).size; });
  Sum sum;
  visit([&](const auto& part) { sum += halved(part, 0, 1, 10 * tolerance * total, 12); });
  return sum;
}

/// Half the chord of a ball at that distance.
inline Real half_chord(Real radius, Real c) {
  return c < radius ? std::sqrt((radius - c) * (radius + c)) : 0;
}

/// Where abscissae counted from the foot meet the kinks of the kernel, and the foot itself.
template <class K>
std::vector<Real> kinks_of_line(const K& kernel, Real c) {
  std::vector<Real> cuts{0};
  for (const double radius : detail::kinks(kernel)) {
    if (!std::isfinite(radius)) continue;
    const Real t = half_chord(radius, c);
    cuts.push_back(t), cuts.push_back(-t);
  }
  return cuts;
}

/// Over the points p - d0 + t axis, 0 <= t <= length: d = d0 - t axis.
template <class K>
Sum over_line(const K& kernel, const Vector& d0, const Vector& axis, Real length) {
  const Real foot = dot(d0, axis);
  const Vector perp = d0 - foot * axis;
  // Counted from the place nearest to the foot, where abscissae need their digits.
  const Real nearest = std::clamp<Real>(foot, 0, length), beyond = nearest - foot;
  const Real reach = reach_of(kernel, std::hypot(norm(perp), beyond));
  const auto part = [&](Real direction, Real extent) {
    std::vector<Real> cuts = kinks_of_line(kernel, norm(perp));
    for (Real& cut : cuts) cut = direction * (cut - beyond);
    close_in(0, extent, reach, cuts);
    const auto at = [&](Real o) {
      return integrand(kernel, perp - (beyond + direction * o) * axis);
    };
    return integral_over(at, extent, cuts, tolerance_for(length + norm(d0), reach));
  };
  Sum sum = part(1, length - nearest);
  sum += part(-1, nearest);
  return sum;
}

template <class K>
Sum exact(const K& kernel, const Segment& segment, const Vector& p) {
  const Vector side = Vector(segment.b) - Vector(segment.a);
  const Real length = norm(side);
  return over_line(kernel, p - Vector(segment.a), side / length, length);
}

template <class K>
Sum exact(const K& kernel, const Arc& arc, const Vector& p) {
  const Vector d = p - Vector(arc.center);
  const Vector ex(arc.ex), ey(arc.ey), n(arc.normal);
  const Real x = dot(d, ex), y = dot(d, ey), z = dot(d, n), c = arc.radius;
  const Real rho = std::hypot(x, y), azimuth = std::atan2(y, x);
  const Vector outward = std::cos(azimuth) * ex + std::sin(azimuth) * ey;
  const Vector around = std::cos(azimuth) * ey - std::sin(azimuth) * ex;
  const auto at = [&](Real phi) {
    const Real s = std::sin(phi / 2);
    return integrand(kernel,
                     (rho - c + 2 * c * s * s) * outward - c * std::sin(phi) * around + z * n);
  };
  std::vector<Real> cuts{0};
  for (const double radius : detail::kinks(kernel)) {
    const Real x2 = (radius - std::hypot(rho - c, z)) * (radius + std::hypot(rho - c, z));
    if (!std::isfinite(radius) || !(x2 > 0) || x2 > 4 * c * rho) continue;
    const Real phi = 2 * std::asin(std::sqrt(x2 / (4 * c * rho)));
    for (const Real cut : {phi, -phi}) cuts.push_back(cut);
  }
  const Real turn = 2 * std::numbers::pi_v<Real>;
  // A full circle has no gap, whatever the rounding of its sweep; it may begin opposite to p.
  const bool full = arc.sweep >= 2 * std::numbers::pi;
  const Real sweep = full ? turn : Real(arc.sweep), turned = full ? 0 : azimuth;
  // Counted from the azimuth of p, whichever turn it is in.
  Sum sum;
  const Real first = -sweep / 2 - turned, last = sweep / 2 - turned;
  std::vector<Real> all;
  for (const Real cut : cuts) {
    for (const Real shifted : {cut - turn, cut, cut + turn}) all.push_back(shifted);
  }
  // The ends carry the rounding of the azimuth, the sweep does not.
  const auto part = [&](Real from, Real to, Real sign) {
    if (!(to > from)) return;
    std::vector<Real> inside;
    for (const Real cut : all) inside.push_back(sign * cut - from);
    const Real length = first >= 0 || last <= 0 ? sweep : to - from;
    const Real least = reach_of(kernel, static_cast<Real>(distance(arc, Vec3d(p)))) / c;
    close_in(0, length, least, inside);
    close_in(length, length, least, inside);
    sum += integral_over([&](Real o) { return at(sign * (from + o)); }, length, inside,
                         tolerance_for(c + norm(d), least * c));
  };
  part(std::max<Real>(first, 0), last, 1);
  part(std::max<Real>(-last, 0), -first, -1);
  return c * sum;
}

/// Chords parallel to the height over the longest edge.
template <class K>
Sum exact(const K& kernel, const Triangle& triangle, const Vector& p) {
  std::array<Vector, 3> v;
  for (std::size_t i = 0; i < 3; ++i) v[i] = Vector(triangle.vertex[i]);
  while (norm(v[1] - v[0]) < std::max(norm(v[2] - v[1]), norm(v[2] - v[0]))) {
    std::rotate(v.begin(), v.begin() + 1, v.end());
  }
  const Real base = norm(v[1] - v[0]);
  const Vector along = (v[1] - v[0]) / base;
  const Real apex = dot(v[2] - v[0], along);
  const Vector up_side = v[2] - v[0] - apex * along;
  const Real height = norm(up_side);
  const Vector up = up_side / height;
  const Vector d0 = p - v[0];
  const Real x = dot(d0, along), y = dot(d0, up), z = norm(d0 - x * along - y * up);
  Sum sum;
  // From either end of the base to the apex.
  const auto part = [&](Real end, Real direction, Real length) {
    const Real slope = height / length;
    const Real foot = direction * (x - end);
    const Real cosine = 1 / std::sqrt(1 + slope * slope);
    const Real side_foot = (foot + slope * y) * cosine * cosine;
    const Real side_distance = (y - slope * foot) * cosine;
    std::vector<Real> cuts;
    for (const Real t : kinks_of_line(kernel, z)) {
      cuts.push_back(foot + t);
      const Real q = std::abs(t);
      for (const Real other : {half_chord(q, std::abs(y)), -half_chord(q, std::abs(y))}) {
        cuts.push_back(foot + other);
      }
      const Real on_side = half_chord(q, std::abs(side_distance)) * cosine;
      cuts.push_back(side_foot + on_side), cuts.push_back(side_foot - on_side);
    }
    const Real least = reach_of(kernel, static_cast<Real>(distance(triangle, Vec3d(p))));
    for (const Real peak : {foot, side_foot, Real(0), length}) {
      close_in(std::clamp<Real>(peak, 0, length), length, least, cuts);
    }
    sum += integral_over(
        [&](Real o) {
          const Vector from = d0 - (end + direction * o) * along;
          return over_line(kernel, from, up, slope * o);
        },
        length, cuts, 3 * tolerance_for(base + norm(d0), least));
  };
  part(0, 1, apex);
  part(base, -1, base - apex);
  return sum;
}

template <class K>
Sum exact(const K& kernel, const Point& point, const Vector& p) {
  return integrand(kernel, p - Vector(point.position));
}

}  // namespace cs2mesh::hessian_oracle
