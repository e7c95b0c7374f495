#include "libfield/integral/taylor_series.h"

#include <algorithm>
#include <cmath>

namespace cs2mesh {
namespace {

/// Replaces the polynomial sum of p[i] t^i, i <= degree, by that in t' with t = offset + scale t'.
template <class At>
void recenter_line(int degree, double offset, double scale, const At& at) {
  // Horner's scheme, repeated: Taylor coefficients at `offset`.
  for (int i = 0; i < degree; ++i) {
    for (int j = degree - 1; j >= i; --j) at(j) += offset * at(j + 1);
  }
  double power = 1.0;
  for (int i = 0; i <= degree; ++i, power *= scale) at(i) *= power;
}

}  // namespace

Series recentered(const Series& series, const Vec3d& offset, double scale) {
  Series out = series;
  // One axis after the other; (a, b) are the powers of the other two.
  const auto every_line = [](const auto& line) {
    for (int a = 0; a <= kTaylorOrder; ++a) {
      for (int b = 0; a + b <= kTaylorOrder; ++b) line(a, b, kTaylorOrder - a - b);
    }
  };
  every_line([&](int a, int b, int degree) {
    recenter_line(degree, offset.z, scale,
                  [&](int i) -> double& { return out[series_index(a, b, i)]; });
  });
  every_line([&](int a, int c, int degree) {
    recenter_line(degree, offset.y, scale,
                  [&](int i) -> double& { return out[series_index(a, i, c)]; });
  });
  every_line([&](int b, int c, int degree) {
    recenter_line(degree, offset.x, scale,
                  [&](int i) -> double& { return out[series_index(i, b, c)]; });
  });
  return out;
}

Series moved_moments(const Series& moments, const Vec3d& offset, double scale) {
  // (-q)^k / k! is a sum of products of such powers of the offset and of scale q': one axis after
  // the other, rows of high powers first, as they take from those of lower ones.
  std::array<double, kTaylorOrder + 1> x, y, z, unit;
  divided_powers(offset.x, 1.0, x.data());
  divided_powers(offset.y, 1.0, y.data());
  divided_powers(offset.z, 1.0, z.data());
  unit[0] = 1.0;
  for (std::size_t n = 1; n < unit.size(); ++n) unit[n] = unit[n - 1] * scale;
  Series out;
  visit_powers([&](int a, int b, int c) {
    const std::size_t place = series_index(a, b, c);
    out[place] = unit[static_cast<std::size_t>(a + b + c)] * moments[place];
  });
  const auto every_row = [&](const auto& move) {
    for (int a = kTaylorOrder; a >= 0; --a) {
      for (int b = kTaylorOrder - a; b >= 0; --b) {
        move(a, b, out.data() + series_index(a, b, 0), kTaylorOrder - a - b);
      }
    }
  };
  const auto add = [&](double factor, int a, int b, double* to, int degree) {
    const double* from = out.data() + series_index(a, b, 0);
    for (int c = 0; c <= degree; ++c) to[c] += factor * from[c];
  };
  every_row([&](int /*a*/, int /*b*/, double* self, int degree) {
    for (int c = degree; c >= 0; --c) {
      for (int m = 1; m <= c; ++m) self[c] += z[static_cast<std::size_t>(m)] * self[c - m];
    }
  });
  every_row([&](int a, int b, double* self, int degree) {
    for (int m = 1; m <= b; ++m) add(y[static_cast<std::size_t>(m)], a, b - m, self, degree);
  });
  every_row([&](int a, int b, double* self, int degree) {
    for (int m = 1; m <= a; ++m) add(x[static_cast<std::size_t>(m)], a - m, b, self, degree);
  });
  return out;
}

Symmetric3 series_hessian(const Series& series, const Vec3d& x) {
  // x^n with its first and second derivatives, by axis.
  std::array<std::array<Vec3d, kTaylorOrder + 1>, 3> power{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    power[axis][0].x = 1.0;
    for (std::size_t n = 1; n < power[axis].size(); ++n) {
      const Vec3d& lower = power[axis][n - 1];
      power[axis][n] = {x[axis] * lower.x, x[axis] * lower.y + lower.x,
                        x[axis] * lower.z + 2.0 * lower.y};
    }
  }
  Symmetric3 sum;
  visit_powers([&](int a, int b, int c) {
    const double k = series[series_index(a, b, c)];
    const Vec3d& p = power[0][static_cast<std::size_t>(a)];
    const Vec3d& q = power[1][static_cast<std::size_t>(b)];
    const Vec3d& r = power[2][static_cast<std::size_t>(c)];
    sum += k * Symmetric3{p.z * q.x * r.x, p.x * q.z * r.x, p.x * q.x * r.z,
                          p.y * q.y * r.x, p.y * q.x * r.y, p.x * q.y * r.y};
  });
  return sum;
}

double derivative_bound(const Series& series, int order) {
  // With B_ij.. bounds of the components, |D^k[e, ..., e]| <= sum B_ij.. |e_i e_j ..|. A product of
  // k numbers is at most the mean of their k-th powers, and B is symmetric, so that is at most
  // sum_i |e_i|^k times the sum of the components with first index i; sum_i |e_i|^k <= 1 from order
  // 2 on, and at order 1 <= sqrt(3).
  std::array<double, 3> row{};
  visit_powers([&](int a, int b, int c) {
    double size = std::abs(series[series_index(a, b, c)]);
    for (int k = 1; k < order; ++k) size *= a + b + c - k;
    row[0] += size * a;
    row[1] += size * b;
    row[2] += size * c;
  });
  const double most = std::max({row[0], row[1], row[2]}) * (1 + 1e-12);
  return order == 1 ? 1.7320508075688774 * most : most;
}

}  // namespace cs2mesh
