// Surfaces whose values, bounds and crossings are known in closed form, for tests of whatever works
// on an ImplicitSurface.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh::test {

/// Fills in the bulk functions from one jet() of the derived class; restriction changes nothing.
template <class Derived>
class AnalyticSurface : public ImplicitSurface {
 public:
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = self().jet_at(points[i]).value;
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = self().jet_at(points[i]);
  }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<Derived>(self());
  }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }
};

inline Interval axis_range(const Aabb& box, std::size_t axis) {
  return {box.min[axis], box.max[axis]};
}
inline Interval square(const Interval& a) {
  const double far = std::max(std::abs(a.lo), std::abs(a.hi));
  const double near = a.contains(0.0) ? 0.0 : std::min(std::abs(a.lo), std::abs(a.hi));
  return {std::max(0.0, next_down(near * near)), next_up(far * far)};
}

/// F = R^2 - |p - c|^2.
class Sphere : public AnalyticSurface<Sphere> {
 public:
  Sphere(Vec3d center, double radius) : c_(center), r_(radius) {}

  Jet jet_at(const Vec3d& p) const { return {r_ * r_ - squared_norm(p - c_), 2.0 * (c_ - p)}; }
  Interval enclose(const Aabb& box) const override {
    Interval d2;
    for (std::size_t k = 0; k < 3; ++k) d2 = d2 + square(axis_range(box, k) - Interval(c_[k]));
    return widened(Interval(r_ * r_) - d2, 1e-15 * (r_ * r_ + d2.hi));
  }
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override {
    std::array<Interval, 3> g;
    for (std::size_t k = 0; k < 3; ++k) {
      g[k] = Interval(-2.0) * (axis_range(box, k) - Interval(c_[k]));
    }
    return g;
  }
  double derivative_bound(int order, const Aabb& box) const override {
    return order == 1 ? 2.0 * box.farthest_distance(c_) : 2.0;
  }
  Aabb bounds() const override {
    const Vec3d r{r_, r_, r_};
    return {c_ - r, c_ + r};
  }

 private:
  Vec3d c_;
  double r_;
};

/// F = sum w exp(-a^2 |p - c|^2) - T, every w > 0.
class GaussianSum : public AnalyticSurface<GaussianSum> {
 public:
  struct Blob {
    Vec3d c;
    double a = 1.0;
    double w = 1.0;
  };
  GaussianSum(std::vector<Blob> blobs, double threshold)
      : blobs_(std::move(blobs)), threshold_(threshold) {}

  Jet jet_at(const Vec3d& p) const {
    Jet sum;
    for (const Blob& b : blobs_) {
      const Vec3d d = p - b.c;
      const double f = b.w * std::exp(-b.a * b.a * squared_norm(d));
      sum += {f, (-2.0 * b.a * b.a * f) * d};
    }
    sum.value -= threshold_;
    return sum;
  }
  Interval enclose(const Aabb& box) const override {
    Interval sum(-threshold_);
    for (const Blob& b : blobs_) sum = sum + value_range(b, box);
    return widened(sum, 1e-14 * threshold_);
  }
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override {
    std::array<Interval, 3> g;
    for (const Blob& b : blobs_) {
      const Interval f = Interval(-2.0 * b.a * b.a) * value_range(b, box);
      for (std::size_t k = 0; k < 3; ++k) {
        g[k] = g[k] + widened(f * (axis_range(box, k) - Interval(b.c[k])), 1e-14);
      }
    }
    return g;
  }
  double derivative_bound(int order, const Aabb& box) const override {
    double sum = 0.0;
    for (const Blob& b : blobs_) {
      const double near = b.a * box.distance(b.c);
      const double v = near * near;
      if (order == 1) {
        const double peak = std::max(near, std::sqrt(0.5));
        sum += b.w * 2.0 * b.a * peak * std::exp(-peak * peak);
      } else {
        // Eigenvalues 2 a^2 e^-v (2 v - 1), and -2 a^2 e^-v twice.
        const double tail = std::max(v, 1.5);
        sum += b.w * 2.0 * b.a * b.a * std::max(std::exp(-v), (2.0 * tail - 1.0) * std::exp(-tail));
      }
    }
    return sum * (1.0 + 1e-12);
  }
  Aabb bounds() const override {
    double total = 0.0;
    for (const Blob& b : blobs_) total += b.w;
    Aabb box;
    for (const Blob& b : blobs_) {
      // Beyond this distance from every centre the sum stays below T.
      const double r = std::sqrt(std::max(0.0, std::log(total / threshold_))) / b.a * (1.0 + 1e-12);
      box.include(Aabb{b.c, b.c}.grown(r));
    }
    return box;
  }

 private:
  static Interval value_range(const Blob& b, const Aabb& box) {
    const double near = b.a * box.distance(b.c);
    const double far = b.a * box.farthest_distance(b.c);
    const Interval range(b.w * std::exp(-far * far), b.w * std::exp(-near * near));
    return widened(range, 1e-14 * range.hi);
  }
  std::vector<Blob> blobs_;
  double threshold_;
};

/// F = 4 R^2 (x^2 + y^2) - (|p|^2 + R^2 - r^2)^2: the torus about the z axis.
class Torus : public AnalyticSurface<Torus> {
 public:
  Torus(double major, double minor) : R_(major), r_(minor) {}

  Jet jet_at(const Vec3d& p) const {
    const double s = squared_norm(p) + R_ * R_ - r_ * r_;
    const double k = 8.0 * R_ * R_;
    return {0.5 * k * (p.x * p.x + p.y * p.y) - s * s, Vec3d{k * p.x, k * p.y, 0.0} - 4.0 * s * p};
  }
  Interval enclose(const Aabb& box) const override {
    const Interval xy = square(axis_range(box, 0)) + square(axis_range(box, 1));
    const Interval f = Interval(4.0 * R_ * R_) * xy - square(s_range(box));
    return widened(f, 1e-13 * R_ * R_ * R_ * R_);
  }
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override {
    const Interval s = Interval(4.0) * s_range(box);
    const Interval k(8.0 * R_ * R_);
    return {(k - s) * axis_range(box, 0), (k - s) * axis_range(box, 1),
            (Interval(0.0) - s) * axis_range(box, 2)};
  }
  double derivative_bound(int order, const Aabb& box) const override {
    const double p = box.farthest_distance({0, 0, 0});
    const double s = s_range(box).magnitude();
    return order == 1 ? (8.0 * R_ * R_ + 4.0 * s) * p : 8.0 * R_ * R_ + 4.0 * s + 8.0 * p * p;
  }
  Aabb bounds() const override {
    const double a = R_ + r_;
    return {{-a, -a, -r_}, {a, a, r_}};
  }

 private:
  Interval s_range(const Aabb& box) const {
    return square(axis_range(box, 0)) + square(axis_range(box, 1)) + square(axis_range(box, 2)) +
           Interval(R_ * R_ - r_ * r_);
  }
  double R_, r_;
};

/// F = min over the six faces of the distance to them: a box, with creases and no second
/// derivative.
class Cube : public AnalyticSurface<Cube> {
 public:
  explicit Cube(double half) : half_(half) {}

  Jet jet_at(const Vec3d& p) const {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (std::abs(p[i]) > std::abs(p[k])) k = i;
    }
    Jet jet{half_ - std::abs(p[k]), {}};
    jet.gradient[k] = p[k] > 0.0 ? -1.0 : 1.0;
    return jet;
  }
  Interval enclose(const Aabb& box) const override {
    Interval f(half_);
    double lo = 0.0;
    double hi = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Interval x = axis_range(box, k);
      hi = std::max(hi, x.magnitude());
      if (!x.contains(0.0)) lo = std::max(lo, std::min(std::abs(x.lo), std::abs(x.hi)));
    }
    return f - Interval(lo, hi);
  }
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override {
    std::array<Interval, 3> g;
    for (std::size_t k = 0; k < 3; ++k) {
      const Interval x = axis_range(box, k);
      g[k] = {x.hi > 0.0 ? -1.0 : 0.0, x.lo < 0.0 ? 1.0 : 0.0};
      bool always = true;
      bool never = false;
      for (std::size_t i = 0; i < 3; ++i) {
        if (i == k) continue;
        const Interval y = axis_range(box, i);
        const double near = x.contains(0.0) ? 0.0 : std::min(std::abs(x.lo), std::abs(x.hi));
        const double other = y.contains(0.0) ? 0.0 : std::min(std::abs(y.lo), std::abs(y.hi));
        always = always && near > y.magnitude();
        never = never || x.magnitude() < other;
      }
      if (never) g[k] = 0.0;
      if (always) g[k] = x.lo > 0.0 ? -1.0 : 1.0;
    }
    return g;
  }
  double derivative_bound(int order, const Aabb&) const override {
    return order == 1 ? 1.0 : std::numeric_limits<double>::infinity();
  }
  Aabb bounds() const override {
    const Vec3d h{half_, half_, half_};
    return {-h, h};
  }

 private:
  double half_;
};

}  // namespace cs2mesh::test
