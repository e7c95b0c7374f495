// The fields of triangles in 50 digits, as a reference: Green's theorem turns them into integrals
// along the edges, which Gauss-Legendre rules of 20 nodes take over panels graded towards the
// singularities. Independent of the library's forms, which never evaluate these integrals.
//
// Legend: of an edge, e the distance from the foot of p in the plane (> 0 on the inner side), t the
// abscissa along it; z the height of p over the plane; u = r^2 = z^2 + e^2 + t^2, H = int h du:
//     f = (1/2) sum e int (H(u) - H0) / (e^2 + t^2) dt,    H0 = H(z^2),
//     grad f = -sum o int h dt + n z sum e int (h(u) - h0) / (e^2 + t^2) dt,    h0 = h(z^2);
// with the foot outside of the triangle H0 and h0 are free, as the edges' angles add up to 0. For 1
// / r there are antiderivatives.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/kernel/kernel.h"
#include "tests/oracle/reference.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/integral/wide_rule.h"

namespace cs2mesh::wide {

using Fifty = boost::multiprecision::cpp_bin_float_50;

/// h and H = int h du as functions of u (H of finite supports vanishes at their edge).
struct WideLaw {
  Fifty h, sum;
};

template <class K>
WideLaw wide_law(const K& kernel, const Fifty& u) {
  if constexpr (std::is_same_v<K, Gaussian>) {
    const Fifty a2 = Fifty(kernel.a) * kernel.a;
    const Fifty h = exp(Fifty(Fifty(kernel.log_amplitude) - a2 * u));
    return {h, -h / a2};
  } else {
    const Fifty amplitude(kernel.amplitude);
    if constexpr (std::is_same_v<K, Inverse>) {
      const Fifty r = sqrt(u);
      return {r > 0 ? Fifty(amplitude / r) : Fifty(0), 2 * amplitude * r};
    } else if constexpr (std::is_same_v<K, Squared>) {
      if (!(u > 0)) return {};
      return {amplitude / u, amplitude * log(u)};
    } else {
      const Fifty r2 = Fifty(kernel.radius) * kernel.radius;
      if (u >= r2) return {};
      const Fifty v = 1 - u / r2;
      if constexpr (std::is_same_v<K, Quartic>) {
        return {amplitude * v * v, -amplitude * r2 * v * v * v / 3};
      } else if constexpr (std::is_same_v<K, Soft>) {
        return {amplitude * v * v * (5 + 4 * v) / 9,
                -amplitude * r2 * v * v * v * (5 + 3 * v) / 27};
      } else {
        const Fifty y2 = u / r2, y = sqrt(y2), m = 1 - y;
        if (9 * u > r2) {
          return {amplitude * 3 * m * m / 2, -amplitude * r2 * m * m * m * (4 - 3 * m) / 4};
        }
        return {amplitude * (1 - 3 * y2), amplitude * r2 * (y2 - 3 * y2 * y2 / 2 - Fifty(13) / 54)};
      }
    }
  }
}

template <class K>
inline constexpr bool kFinite = requires(const K& kernel) {
  kernel.radius;
};

template <class K>
inline constexpr bool kIsPolynomialLaw = std::is_same_v<K, Soft> || std::is_same_v<K, Quartic>;

struct EdgeIntegrals {
  Fifty value = 0, normal = 0, line = 0;
  bool within = false;  ///< part of it is within the support
};

template <class K>
class EdgeSum {
 public:
  EdgeSum(const K& kernel, const Fifty& e, const Fifty& z2, bool outside)
      : kernel_(kernel),
        e_(e),
        z2_(z2),
        base_(outside && !kFinite<K> ? WideLaw{} : wide_law(kernel, z2)) {
    // Removable at e^2 + t^2 = 0 with H0 = H(z^2), if both are of one piece.
    gap2_ = outside ? Fifty(e * e) : Fifty(e * e + z2);
    if constexpr (std::is_same_v<K, Gaussian>) {
      if (!outside) gap2_ = (std::max)(gap2_, Fifty(1 / (Fifty(kernel.a) * kernel.a)));
    }
  }

  /// Adds the stretch 0 <= t1 <= t <= t2 of an edge.
  void add(const Fifty& t1, const Fifty& t2) {
    if (!(t2 > t1)) return;
    if constexpr (kFinite<K>) {
      const Fifty r2 = Fifty(kernel_.radius) * kernel_.radius;
      const Fifty middle = (t1 + t2) / 2;
      if (z2_ + e_ * e_ + middle * middle >= r2) {
        const Fifty angle = atan2(Fifty(e_ * (t2 - t1)), Fifty(e_ * e_ + t1 * t2));
        sum.value -= angle * base_.sum / 2;
        sum.normal -= angle * base_.h;
        return;
      }
      sum.within = true;
      // Of one piece with H(z^2) or not.
      const bool mixed = 9 * z2_ < r2 && 9 * (z2_ + e_ * e_ + middle * middle) > r2;
      gap2_ = mixed ? Fifty(e_ * e_) : Fifty(e_ * e_ + z2_);
    }
    if constexpr (std::is_same_v<K, Inverse>) {
      add_inverse(t1, t2);
    } else {
      add_panel(t1, t2, t1, 0);
    }
  }
  EdgeIntegrals sum;

 private:
  bool must_split(const Fifty& a, const Fifty& b, const Fifty& nearest) const {
    if (kIsPolynomialLaw<K>) return false;
    if (sqrt(Fifty(a * a + gap2_)) + sqrt(Fifty(b * b + gap2_)) < 2.2 * (b - a)) return true;
    if constexpr (std::is_same_v<K, Gaussian>) {
      const Fifty a2 = Fifty(kernel_.a) * kernel_.a;
      const bool there = a2 * (a * a - nearest * nearest) < 70;
      return there && (a2 * (b - a) * (b - a) > 2 || a2 * (b * b - a * a) > 5);
    }
    return false;
  }
  void add_inverse(const Fifty& t1, const Fifty& t2) {
    const Fifty c2 = e_ * e_ + z2_, z = sqrt(z2_);
    const Fifty r1 = sqrt(Fifty(c2 + t1 * t1)), r2 = sqrt(Fifty(c2 + t2 * t2));
    const Fifty line = log(Fifty((r2 + t2) / (r1 + t1)));
    const Fifty angle =
        atan2(Fifty(e_ * t2), Fifty(c2 + z * r2)) - atan2(Fifty(e_ * t1), Fifty(c2 + z * r1));
    sum.line += Fifty(kernel_.amplitude) * line;
    sum.value += Fifty(kernel_.amplitude) * (e_ * line - z * angle);
    if (z > 0) sum.normal -= Fifty(kernel_.amplitude) * angle / z;
  }
  void add_panel(const Fifty& a, const Fifty& b, const Fifty& nearest, int depth) {
    if (depth < 150 && must_split(a, b, nearest)) {
      const Fifty middle = (a + b) / 2;
      add_panel(a, middle, nearest, depth + 1);
      add_panel(middle, b, nearest, depth + 1);
      return;
    }
    const auto& rule = wide_rule<Fifty, 20>();
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const Fifty t = a + (b - a) * rule.node[i];
      const Fifty q = e_ * e_ + t * t;
      const WideLaw law = wide_law(kernel_, Fifty(z2_ + q));
      const Fifty weight = (b - a) * rule.weight[i];
      if (e_ != 0) {
        sum.value += weight * e_ * (law.sum - base_.sum) / (2 * q);
        sum.normal += weight * e_ * (law.h - base_.h) / q;
      }
      sum.line += weight * law.h;
    }
  }

  const K& kernel_;
  Fifty e_, z2_;
  WideLaw base_;
  Fifty gap2_;
};

/// Value and gradient; p off the triangle for the kernels that are unbounded there.
template <class K>
JetOf<Fifty> triangle_field(const K& kernel, const Triangle& triangle, const Vec3<Fifty>& p) {
  const TriangleFrame<Fifty> frame(triangle);
  const Fifty z = dot(p - frame.vertex[0], frame.normal);
  std::array<Fifty, 3> e;
  bool outside = false;
  for (std::size_t i = 0; i < 3; ++i) {
    e[i] = -dot(p - frame.vertex[i], frame.edge[i].outward);
    // On an edge or a vertex rounding decides on the sides; the form with H(z^2) is indifferent.
    outside = outside || e[i] < -1e-20 * frame.edge[0].length;
  }
  JetOf<Fifty> jet;
  Fifty normal = 0;
  bool within = !kFinite<K> || !outside;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& edge = frame.edge[i];
    const Fifty t1 = dot(frame.vertex[i] - p, edge.along);
    const Fifty t2 = t1 + edge.length;
    EdgeSum<K> edge_sum(kernel, e[i], Fifty(z * z), outside);
    // Cut where a derivative of the kernel jumps, and at the foot.
    std::array<Fifty, 7> cut{t1, t2, Fifty(0)};
    std::size_t count = 3;
    if constexpr (kFinite<K>) {
      for (const int part : {1, 3}) {
        const Fifty r = Fifty(kernel.radius) / part;
        const Fifty tau = sqrt((std::max)(Fifty(0), Fifty(r * r - z * z - e[i] * e[i])));
        cut[count++] = tau, cut[count++] = -tau;
      }
    }
    std::sort(cut.begin(), cut.begin() + count);
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const Fifty a = (std::max)(cut[k], t1), b = (std::min)(cut[k + 1], t2);
      if (a >= 0) edge_sum.add(a, b);
      if (b <= 0) edge_sum.add(-b, -a);
    }
    within = within || edge_sum.sum.within;
    jet.value += edge_sum.sum.value;
    normal += z * edge_sum.sum.normal;
    jet.gradient -= edge_sum.sum.line * edge.outward;
  }
  if (!within) return {};
  if constexpr (std::is_same_v<K, Gaussian>)
    normal = -2 * Fifty(kernel.a) * kernel.a * z * jet.value;
  jet.gradient += normal * frame.normal;
  return jet;
}

/// As exact_field of wide.h.
template <class K>
reference::Exact exact_triangle(const K& kernel, const Triangle& triangle, const Vec3d& point,
                                double scale, double condition) {
  return exact_of<Fifty>([&](const Vec3<Fifty>& p) { return triangle_field(kernel, triangle, p); },
                         point, scale, condition, Fifty("1e-18"));
}

}  // namespace cs2mesh::wide
