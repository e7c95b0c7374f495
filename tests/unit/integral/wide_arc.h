// Fields of arcs to 25 digits and more, for kernels without a closed form to compare with:
// Gauss-Legendre with forty nodes a panel in numbers of 113 bits, on panels that end where a
// derivative of the kernel jumps and shrink towards its singularities.
//
// Legend: phi the angle counted from the azimuth of p; u = m + gap sin^2(phi / 2) the squared
// distance; K = dh/du.
#pragma once

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <numbers>
#include <type_traits>
#include <vector>

#include "libfield/kernel/kernel.h"
#include "libfield/primitive/arc.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/integral/wide_rule.h"

namespace cs2mesh::wide {

using Quad = boost::multiprecision::cpp_bin_float_quad;

template <class K>
class ArcQuadrature {
 public:
  ArcQuadrature(const K& kernel, const Quad& m, const Quad& gap)
      : kernel_(kernel), m_(m), gap_(gap) {}

  /// Adds the integrals over [from, to].
  void add(const Quad& first, const Quad& last) {
    std::vector<Quad> cuts{first, last};
    const Quad& turn = boost::math::constants::two_pi<Quad>();
    const auto cut = [&](const Quad& angle) {
      for (const Quad& x : {angle, Quad(-angle), Quad(angle - turn), Quad(-angle - turn)}) {
        if (first < x && x < last) cuts.push_back(x);
      }
    };
    cut(0), cut(turn / 2);
    if (std::isfinite(kernel_.support())) {
      cut(angle_of(Quad(kernel_.support())));
      if constexpr (std::is_same_v<K, Metaball>) cut(angle_of(Quad(kernel_.support()) / 3));
    }
    std::sort(cuts.begin(), cuts.end());
    if constexpr (std::is_same_v<K, Gaussian>) {
      least_ = squared(first) < squared(last) ? squared(first) : squared(last);
      for (const Quad& x : cuts) least_ = (std::min)(least_, squared(x));
    }
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) halve(cuts[i], cuts[i + 1], 60);
  }

  Quad value = 0, n0 = 0, n1 = 0, ns = 0;

 private:
  Quad squared(const Quad& phi) const {
    const Quad s = sin(phi / 2);
    return m_ + gap_ * s * s;
  }
  /// Where u reaches radius^2; 0 if nowhere.
  Quad angle_of(const Quad& radius) const {
    const Quad x = radius * radius - m_;
    return x > 0 && x < gap_ ? Quad(2 * asin(sqrt(x / gap_))) : Quad(0);
  }
  bool beyond_reach(const Quad& a, const Quad& b) const {
    if constexpr (std::is_same_v<K, Gaussian>) {
      const Quad a2 = Quad(kernel_.a) * kernel_.a;
      return a2 * ((std::min)(squared(a), squared(b)) - least_) > 80;
    } else {
      return squared((a + b) / 2) >= Quad(kernel_.support()) * kernel_.support();
    }
  }
  bool smooth(double a, double b) const {
    if (b - a > 1.6) return false;
    const auto m = static_cast<double>(m_), gap = static_cast<double>(gap_);
    if constexpr (std::is_same_v<K, Gaussian>) {
      const double fall = std::abs(static_cast<double>(squared(a) - squared(b)));
      return kernel_.a * std::sqrt(gap) * (b - a) < 8 && kernel_.a * kernel_.a * fall < 50;
    } else if constexpr (std::is_same_v<K, Metaball>) {
      const double height = gap > 0 ? 2 * std::asinh(std::sqrt(m / gap)) : 1e3;
      const auto clear = [&](double at) {
        return std::hypot(a - at, height) + std::hypot(b - at, height) > 2.2 * (b - a);
      };
      if (9 * squared((a + b) / 2) < Quad(kernel_.radius) * kernel_.radius) return true;
      return clear(0) && clear(-6.283185307179586);
    }
    return true;
  }
  void halve(const Quad& a, const Quad& b, int depth) {
    if (!(a < b) || beyond_reach(a, b)) return;
    if (depth > 0 && !smooth(static_cast<double>(a), static_cast<double>(b))) {
      const Quad middle = (a + b) / 2;
      halve(a, middle, depth - 1);
      halve(middle, b, depth - 1);
      return;
    }
    const auto& rule = wide_rule<Quad, 40>();
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const Quad half = (a + rule.node[i] * (b - a)) / 2;
      const Quad s = sin(half), u = m_ + gap_ * s * s;
      const Quad root = sqrt((1 - s) * (1 + s));
      const Quad c = 2 * half > -boost::math::constants::pi<Quad>() ? root : Quad(-root);
      const Quad weight = rule.weight[i] * (b - a), k = weight * kernel_.slope(u);
      value += weight * kernel_.profile(u);
      n0 += k;
      n1 += 2 * k * s * s;
      ns += 2 * k * s * c;
    }
  }

  K kernel_;
  Quad m_, gap_, least_ = 0;
};

/// Value and gradient.
template <class K>
JetOf<Quad> arc_field(const K& kernel, const Arc& arc, const Vec3<Quad>& p) {
  const Vec3<Quad> d = p - Vec3<Quad>(arc.center), ex(arc.ex), ey(arc.ey), n(arc.normal);
  const Quad x = dot(d, ex), y = dot(d, ey), z = dot(d, n), c = arc.radius;
  const Quad rho = sqrt(x * x + y * y);
  const Quad cosine = rho > 0 ? Quad(x / rho) : Quad(1), sine = rho > 0 ? Quad(y / rho) : Quad(0);
  const Quad alpha = atan2(Quad(abs(sine)), cosine);
  const Quad& pi = boost::math::constants::pi<Quad>();
  // What double rounds off a turn is no gap in a circle.
  const Quad half = arc.sweep < 2 * std::numbers::pi ? Quad(Quad(arc.sweep) / 2) : pi;
  ArcQuadrature<K> sum(kernel, (rho - c) * (rho - c) + z * z, 4 * c * rho);
  sum.add(-half - alpha, half - alpha);
  const Quad radial = (rho - c) * sum.n0 + c * sum.n1;
  const Quad around = sine < 0 ? Quad(c * sum.ns) : Quad(-c * sum.ns);
  return {c * sum.value, (2 * c * (radial * cosine - around * sine)) * ex +
                             (2 * c * (radial * sine + around * cosine)) * ey +
                             (2 * c * (z * sum.n0)) * n};
}

/// Value, gradient and |Hessian|.
template <class K>
reference::Exact exact_arc_field(const K& kernel, const Arc& arc, const Vec3d& point, double scale,
                                 double condition) {
  return exact_of<Quad>([&](const Vec3<Quad>& p) { return arc_field(kernel, arc, p); }, point,
                        scale, condition, Quad("1e-16"));
}

}  // namespace cs2mesh::wide
