// Upper bounds of a field and its derivatives at every point that is at least a given distance d
// away from the primitive. A derivative of the field is the integral of that of the kernel, whose
// norm at distance r is at most env(r), the kernel's non-increasing derivative envelope. So the
// bound is the integral of env over the primitive in the arrangement that brings the most of it
// near p, from above by the sum over panels of env at a panel's near end:
//  - Segment: its foot is at its middle, element t is at sqrt(d^2 + t^2).
//  - Triangle of area A: among all flat sets of that area the disk about the foot is worst; also
//    its height times the bound of its longest edge, better for slivers.
//  - Arc of radius c: with rho the distance of p from the circle's axis, the element at an angle
//  phi
//    from the azimuth of p is at squared distance u(phi) = u(0) + 4 c rho sin^2(phi / 2), and
//    u(phi)
//    >= c^2 sin^2 phi (phi <= pi/2; c^2 beyond) for any rho. So u >= d^2 + 3.2 c^2 sin^2(phi / 2)
//    where rho >= 0.8 c, else u >= max(d, 0.2 c, c sin phi)^2. Both are worst for the arc's middle
//    nearest to p: each level of these is shorter anywhere else.
//  - TaperedSegment: at most the greatest |w| times the bound of its axis.
//  - Plane: greatest values of its closed form.
// Non-increasing in d. About 40 to 200 ns.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "libfield/integral/plane.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

namespace detail {

/// Calls visit(t0, t1) for panels that cover [0, end]. Their places do not depend on the distance,
/// so that sums over them fall with it. Kernels with a length: panels grow by a quarter from a
/// seventh of it, then double. Inverse kernels: panels shrink by sqrt(2) from `end` to a millionth
/// of it.
template <class K, class Visit>
void visit_bound_panels(const K& kernel, double end, const Visit& visit) {
  if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
    double t = end;
    for (int i = 0; i < 40; ++i) {
      const double next = t * (0.5 * std::numbers::sqrt2);
      visit(next, t);
      t = next;
    }
    visit(0.0, t);
  } else {
    constexpr int kMostPanels = 60;
    double t = 0.0;
    double step = 0.15 * std::min(kernel.length_scale(), 0.7 * kernel.support());
    for (int i = 0; i < kMostPanels && t + step < end; ++i) {
      visit(t, t + step);
      t += step;
      step *= i < 14 ? 1.25 : 2.0;
    }
    if (t < end) visit(t, end);
  }
}

inline double distance_at(double d, double t) {
  return std::sqrt(d * d + t * t) * (1.0 - 1e-15);
}

/// The bound for a segment of that length.
template <class K>
double length_bound(const K& kernel, double length, int order, double d) {
  double sum = 0.0;
  visit_bound_panels(kernel, 0.5 * length, [&](double t0, double t1) {
    sum += 2.0 * (t1 - t0) * kernel.derivative_envelope(order, distance_at(d, t0));
  });
  return rounded_up(sum);
}

}  // namespace detail

/// An upper bound of the operator norm of the derivative of that order (0 to 4) of the field at
/// all points at least `distance` >= 0 away from the primitive, the kernel's amplitude included.
/// Infinite where there is none, as from order 3 on (on planes: 4) within a finite support.
template <class K>
double derivative_bound(const K& kernel, const Point&, int order, double distance) {
  return kernel.derivative_envelope(order, distance);
}

template <class K>
double derivative_bound(const K& kernel, const Segment& segment, int order, double distance) {
  return detail::length_bound(kernel, measure(segment), order, distance);
}

/// What a derivative of the field is at most times the kernel's envelope at the near end: the
/// measure of the primitive, weighted.
template <class P>
double mass_bound(const P& primitive) {
  return measure(primitive);
}
inline double mass_bound(const TaperedSegment& segment) {
  return range(segment.weight).magnitude() * measure(segment.axis);
}

template <class K>
double derivative_bound(const K& kernel, const TaperedSegment& segment, int order,
                        double distance) {
  return rounded_up(range(segment.weight).magnitude() *
                    derivative_bound(kernel, segment.axis, order, distance));
}

template <class K>
double derivative_bound(const K& kernel, const Arc& arc, int order, double distance) {
  constexpr double kInner = 0.8;  // of the radius: rho beyond and within
  const double c = arc.radius;
  const double half_length = 0.5 * c * arc.sweep;
  // sin x >= x - x^3 / 6, which grows up to x = sqrt(2).
  const auto sine = [](double angle) {
    const double x = std::min(angle, 1.414);
    return x - x * x * x / 6.0;
  };
  double outer = 0.0;
  const double chord_scale = 2.0 * std::sqrt(kInner) * c;
  detail::visit_bound_panels(kernel, half_length, [&](double t0, double t1) {
    const double at = detail::distance_at(distance, chord_scale * sine(0.5 * t0 / c));
    outer += 2.0 * (t1 - t0) * kernel.derivative_envelope(order, at);
  });
  const double least = std::max(distance, (1.0 - kInner) * c);
  double inner = 2.0 * half_length * kernel.derivative_envelope(order, least);
  if (inner > outer) {
    inner = 0.0;
    detail::visit_bound_panels(kernel, half_length, [&](double t0, double t1) {
      const double at = std::max(least, c * sine(t0 / c) * (1.0 - 1e-15));
      inner += 2.0 * (t1 - t0) * kernel.derivative_envelope(order, at);
    });
  }
  return rounded_up(std::max(inner, outer));
}

template <class K>
double derivative_bound(const K& kernel, const Triangle& triangle, int order, double distance) {
  const double area = measure(triangle) * (1.0 + 1e-14);
  double disk = 0.0;
  const double disk_radius = std::sqrt(area / std::numbers::pi);
  detail::visit_bound_panels(kernel, disk_radius, [&](double t0, double t1) {
    disk += std::numbers::pi * (t1 - t0) * (t1 + t0) *
            kernel.derivative_envelope(order, detail::distance_at(distance, t0));
  });
  const double longest = size(triangle);
  if (longest > 4.0 * disk_radius) {
    const double height = 2.0 * area / longest;
    disk = std::min(disk, height * detail::length_bound(kernel, longest, order, distance));
  }
  return rounded_up(disk);
}

template <class K>
double derivative_bound(const K& kernel, const Plane&, int order, double distance) {
  if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
    return std::numeric_limits<double>::infinity();
  } else {
    // The value falls with the distance; digits lost near the edge of a support are given back.
    if (order == 0) {
      const double nearer = distance * (1.0 - 1e-15);
      return rounded_up(detail::plane_value(kernel, nearer));
    }
    return rounded_up(2.0 * std::numbers::pi * detail::plane_slope_bound(kernel, order, distance));
  }
}

}  // namespace cs2mesh
