// The error of taking a segment of a far field for a few weighted points, the nodes of a
// Gauss-Legendre rule.
//
// On the segment m + u h, |u| <= 1, the kernel is a power of v = H^2 (u - z)(u - z*), H = |h|, and
// its pole z lies on the ellipse about -1 and 1 the sum of whose half axes is rho,
//     rho + 1 / rho = (r1 + r2) / H,
// with r1^2 and r2^2 the squared distances from the place to the ends, tau added. With
// 2 u = w + 1 / w and 2 z = w0 + 1 / w0, |w0| = rho, that is a product of four factors,
//     v = (rho H / 2)^2 |(1 - w / w0)(1 - 1 / (w w0))|^2,   |w| = 1,
// so that the coefficients 2 a_k of v^-nu by Chebyshev's polynomials T_k, which are those of w^k,
// are at most those of ((1 - w / rho)(1 - 1 / (w rho)))^-2nu times (2 / (rho H))^2nu. With c_i =
// binomial(2 nu + i - 1, i), c_(k + j) <= c_k r^j, r = (k + 2 nu) / (k + 1) >= 1,
//     a_k <= (2 / (rho H))^2nu c_k rho^-k (1 - r rho^-2)^-2nu.
// n nodes integrate T_k exactly where k < 2n or k is odd. The error of T_2n is that of its
// leading power, e_n = 2^(4n) (n!)^4 / ((2n + 1) (2n)!^2), and that of any other T_k at most
// 2 + 2 / (k^2 - 1) <= 32 / 15. So of weight 1, whose u is integrated over with 1/2, n nodes leave
// at most, with x = r^2 rho^-2 < 1, k = 2n,
//     (2 / (rho H))^2nu e_n c_k rho^-k (1 - r rho^-2)^-2nu (1 + 32 / (15 e_n) x / (1 - x)).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "libfield/base/vec.h"
#include "libfield/integral/far_sum.h"

namespace cs2mesh {

/// The numbers in that bound.
struct NodeBound {
  int nodes = 0;
  double factor = 0.0;  ///< e_n c_2n, rounded up
  double ratio = 0.0;   ///< r
  double more = 0.0;    ///< 32 / (15 e_n) - 1
};

/// For kernels of the exponent 2 nu >= 1, n >= 2.
NodeBound node_bound(double two_nu, int n);

/// Of each number of nodes in a list.
template <std::size_t N>
using NodeBounds = std::array<NodeBound, N>;
/// Of the rules of kNodeRules but the first, and of kFarNodes.
NodeBounds<kNodeRules.size() - 1> rule_bounds(double two_nu);
NodeBounds<kFarNodes.size()> sum_bounds(double two_nu);

namespace detail {

/// x^2nu for 2 nu of 1, 2 and 4.
template <class T>
T whole_power(double two_nu, const T& x) {
  if (two_nu == 1.0) return x;
  const T x2 = x * x;
  return two_nu == 2.0 ? x2 : T(x2 * x2);
}

}  // namespace detail

/// The bound of n nodes relative to (2 / (rho H))^2nu is over / under, from y = rho^-2 and y^n;
/// none where under <= 0.
template <class T>
struct NodeError {
  T over, under;

  NodeError(double two_nu, const NodeBound& bound, const T& y, const T& power) {
    const T x = T(bound.ratio * bound.ratio) * y;
    over = T(bound.factor) * power * (T(1) + T(bound.more) * x);
    under = (T(1) - x) * detail::whole_power(two_nu, T(T(1) - T(bound.ratio) * y));
  }
};

/// rho^-2 of a place at the distance `apart` from a segment of that half length, or farther.
inline double node_ellipse(double half, double apart) {
  const double over_rho = half / (apart + std::sqrt(half * half + apart * apart));
  return over_rho * over_rho;
}

/// rho^-2 of all places of a cube of that half edge, the least of them: r1 + r2 is convex, and so
/// nowhere less than its tangent. d from the middle of the segment to the centre; over_half = 1 /
/// H.
template <class T>
T node_ellipse(const Vec3<T>& d, const Vec3<T>& half, const T& over_half, const T& tau,
               double edge) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const Vec3<T> a{d.x + half.x, d.y + half.y, d.z + half.z};
  const Vec3<T> b{d.x - half.x, d.y - half.y, d.z - half.z};
  const auto distance = [&](const Vec3<T>& v) {
    const T squared = fma(v.x, v.x, fma(v.y, v.y, fma(v.z, v.z, tau)));
    return T(sqrt(max(squared, T(1e-280))));
  };
  const T r1 = distance(a), r2 = distance(b), over = T(1) / (r1 * r2);
  const T over1 = over * r2, over2 = over * r1;
  const T slope = abs(a.x * over1 + b.x * over2) + abs(a.y * over1 + b.y * over2) +
                  abs(a.z * over1 + b.z * over2);
  const T sum = (r1 + r2 - T(edge) * slope) * T(1 - 1e-12);
  const T axis = max(sum * (T(0.5) * over_half), T(1));
  const T rho = axis + sqrt(axis * axis - T(1));
  return T(1) / (rho * rho);
}

}  // namespace cs2mesh
