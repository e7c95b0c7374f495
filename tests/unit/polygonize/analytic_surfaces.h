// Implicit surfaces with closed forms, for tests of whatever takes an ImplicitSurface. Each is one
// function template; values, gradients and enclosures are that function over doubles, jets and
// intervals.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/implicit_surface.h"

namespace cs2mesh::analytic {

using std::cos;
using std::sin;
using std::sqrt;

inline double square(double x) {
  return x * x;
}
inline Interval square(const Interval& x) {
  const double hi = x.magnitude();
  const double lo = x.contains(0.0) ? 0.0 : std::min(std::abs(x.lo), std::abs(x.hi));
  return {std::max(0.0, next_down(lo * lo)), next_up(hi * hi)};
}
inline Interval sqrt(const Interval& x) {
  return {std::max(0.0, next_down(std::sqrt(std::max(0.0, x.lo)))), next_up(std::sqrt(x.hi))};
}
inline Interval cos(const Interval& x) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kSlack = 1e-12;
  if (!(x.width() < 2 * kPi)) return {-1.0, 1.0};
  const double a = std::cos(x.lo);
  const double b = std::cos(x.hi);
  Interval range{std::min(a, b) - kSlack, std::max(a, b) + kSlack};
  // A whole multiple of pi inside is an extremum: even ones are maxima.
  for (double k = std::ceil((x.lo - kSlack) / kPi); k * kPi <= x.hi + kSlack; ++k) {
    (std::fmod(std::abs(k), 2.0) == 0.0 ? range.hi : range.lo) =
        std::fmod(std::abs(k), 2.0) == 0.0 ? 1.0 : -1.0;
  }
  return range;
}
inline Interval sin(const Interval& x) {
  return cos(x - Interval(std::numbers::pi / 2));
}
inline double reciprocal(double x) {
  return 1.0 / x;
}
inline Interval reciprocal(const Interval& x) {
  if (x.contains(0.0)) return Interval::everything();
  return outward(1.0 / x.hi, 1.0 / x.lo);
}

/// A value with its gradient, over doubles or intervals.
template <class T>
struct Dual {
  T v{};
  Vec3<T> g{};
  Dual() = default;
  Dual(double constant) : v(constant) {}  // NOLINT(google-explicit-constructor)
  Dual(const T& value, const Vec3<T>& gradient) : v(value), g(gradient) {}
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.g + b.g}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.g - b.g}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.v * b.g + b.v * a.g}; }
  friend Dual square(const Dual& a) { return {square(a.v), (T(2.0) * a.v) * a.g}; }
  friend Dual sqrt(const Dual& a) {
    const T root = sqrt(a.v);
    return {root, (T(0.5) * reciprocal(root)) * a.g};
  }
  friend Dual cos(const Dual& a) { return {cos(a.v), (T(-1.0) * sin(a.v)) * a.g}; }
  friend Dual sin(const Dual& a) { return {sin(a.v), cos(a.v) * a.g}; }
};

inline double smaller(double a, double b) {
  return std::min(a, b);
}
inline Interval smaller(const Interval& a, const Interval& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}
inline Dual<double> smaller(const Dual<double>& a, const Dual<double>& b) {
  return a.v <= b.v ? a : b;
}
inline Dual<Interval> smaller(const Dual<Interval>& a, const Dual<Interval>& b) {
  if (a.v.hi < b.v.lo) return a;
  if (b.v.hi < a.v.lo) return b;
  return {smaller(a.v, b.v), {hull(a.g.x, b.g.x), hull(a.g.y, b.g.y), hull(a.g.z, b.g.z)}};
}
template <class T>
T larger(const T& a, const T& b) {
  return T(0.0) - smaller(T(0.0) - a, T(0.0) - b);
}

/// `Function` has `template <class T> T operator()(const Vec3<T>&) const` and `Aabb bounds()
/// const`.
template <class Function>
class Surface final : public ImplicitSurface {
 public:
  explicit Surface(Function f = {}) : f_(f) {}

  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = f_(points[i]);
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d& p = points[i];
      using D = Dual<double>;
      const D d = f_(Vec3<D>{D{p.x, {1, 0, 0}}, D{p.y, {0, 1, 0}}, D{p.z, {0, 0, 1}}});
      out[i] = {d.v, d.g};
    }
  }
  Interval enclose(const Aabb& box) const override { return f_(intervals(box)); }
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override {
    const Vec3<Interval> p = intervals(box);
    using D = Dual<Interval>;
    const D d =
        f_(Vec3<D>{D{p.x, {1.0, 0.0, 0.0}}, D{p.y, {0.0, 1.0, 0.0}}, D{p.z, {0.0, 0.0, 1.0}}});
    return {d.g.x, d.g.y, d.g.z};
  }
  double derivative_bound(int order, const Aabb& box) const override {
    if (order != 1) return std::numeric_limits<double>::infinity();
    const auto g = enclose_gradient(box);
    return norm(Vec3d{g[0].magnitude(), g[1].magnitude(), g[2].magnitude()});
  }
  Aabb bounds() const override { return f_.bounds(); }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& /*box*/) const override {
    return std::make_unique<Surface>(f_);
  }
  const Function& function() const { return f_; }

 private:
  static Vec3<Interval> intervals(const Aabb& box) {
    return {{box.min.x, box.max.x}, {box.min.y, box.max.y}, {box.min.z, box.max.z}};
  }
  Function f_;
};

inline Aabb cube(double half_side, const Vec3d& center = {}) {
  return Aabb{center, center}.grown(half_side);
}

template <class T>
T ball(const Vec3<T>& p, const Vec3d& center, double radius) {
  return T(radius * radius) - square(p.x - T(center.x)) - square(p.y - T(center.y)) -
         square(p.z - T(center.z));
}

struct Sphere {
  Vec3d center{};
  double radius = 1.0;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return ball(p, center, radius);
  }
  Aabb bounds() const { return cube(radius, center); }
};

struct Ellipsoid {
  Vec3d semi_axes{1.0, 0.6, 0.3};
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(1.0) - square(p.x * T(1 / semi_axes.x)) - square(p.y * T(1 / semi_axes.y)) -
           square(p.z * T(1 / semi_axes.z));
  }
  Aabb bounds() const { return Aabb{-semi_axes, semi_axes}.grown(1e-9); }
};

/// Around the z axis.
struct Torus {
  double major = 1.0;
  double minor = 0.3;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(minor * minor) - square(sqrt(square(p.x) + square(p.y)) - T(major)) - square(p.z);
  }
  Aabb bounds() const {
    const double reach = major + minor;
    return {{-reach, -reach, -minor}, {reach, reach, minor}};
  }
};

/// Below z = x^2 - y^2, in a ball; has a crease where the two meet.
struct ClippedSaddle {
  double radius = 1.0;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return smaller(square(p.x) - square(p.y) - p.z, ball(p, {}, radius));
  }
  Aabb bounds() const { return cube(radius); }
};

/// One side of the gyroid of wave number `waves`, in a ball.
struct GyroidInBall {
  double waves = 6.0;
  double radius = 1.0;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const Vec3<T> q{p.x * T(waves), p.y * T(waves), p.z * T(waves)};
    return smaller(sin(q.x) * cos(q.y) + sin(q.y) * cos(q.z) + sin(q.z) * cos(q.x),
                   ball(p, {}, radius));
  }
  Aabb bounds() const { return cube(radius); }
};

/// Two balls of radius 1/2 that touch in the origin.
struct TouchingSpheres {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return larger(ball(p, {-0.5, 0, 0}, 0.5), ball(p, {0.5, 0, 0}, 0.5));
  }
  Aabb bounds() const { return {{-1, -0.5, -0.5}, {1, 0.5, 0.5}}; }
};

/// Two balls of radius 1/2 with that much room between them.
struct TwoSpheres {
  double gap = 0.1;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const double x = 0.5 + 0.5 * gap;
    return larger(ball(p, {-x, 0, 0}, 0.5), ball(p, {x, 0, 0}, 0.5));
  }
  Aabb bounds() const { return {{-1 - 0.5 * gap, -0.5, -0.5}, {1 + 0.5 * gap, 0.5, 0.5}}; }
};

/// Where the product of the squared distances from two points on the x axis is at most `level`: two
/// blobs, which from a level of focus^4 on are joined at a saddle in the origin.
struct CassiniOval {
  double focus = 1.0;
  double level = 1.1;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const T across = square(p.y) + square(p.z);
    return T(level) - (square(p.x - T(focus)) + across) * (square(p.x + T(focus)) + across);
  }
  Aabb bounds() const {
    const double reach = std::sqrt(focus * focus + std::sqrt(level)) + 1e-9;
    return {{-reach, -reach, -reach}, {reach, reach, reach}};
  }
};

/// Its faces are perpendicular to the axes.
struct Box {
  Vec3d half_sides{0.5, 0.4, 0.3};
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return smaller(smaller(T(half_sides.x * half_sides.x) - square(p.x),
                           T(half_sides.y * half_sides.y) - square(p.y)),
                   T(half_sides.z * half_sides.z) - square(p.z));
  }
  Aabb bounds() const { return {-half_sides, half_sides}; }
};

/// |z| <= half_thickness, in a ball.
struct ThinPlate {
  double half_thickness = 0.01;
  double radius = 1.0;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return smaller(T(half_thickness * half_thickness) - square(p.z), ball(p, {}, radius));
  }
  Aabb bounds() const { return cube(radius); }
};

/// Trilinear between random values at whole coordinates 1 .. size - 1; -1 on the border of the cube
/// and beyond. Every pattern of signs occurs. `smallest` is the least magnitude of a value.
class LatticeNoise final : public ImplicitSurface {
 public:
  LatticeNoise(int size, double share_inside, double smallest, std::uint64_t seed)
      : size_(size), share_inside_(share_inside), smallest_(smallest), seed_(seed) {}

  double node(int i, int j, int k) const {
    if (std::min({i, j, k}) <= 0 || std::max({i, j, k}) >= size_) return -1.0;
    Random random(seed_, static_cast<std::uint64_t>((i * 4096 + j) * 4096 + k));
    const double sign = random.uniform() < share_inside_ ? 1.0 : -1.0;
    return sign * random.uniform(smallest_, 1.0);
  }
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]).value;
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]);
  }
  Interval enclose(const Aabb& box) const override {
    return box.overlaps(bounds()) ? Interval{-1.0, 1.0} : Interval{-1.0, -1.0};
  }
  std::array<Interval, 3> enclose_gradient(const Aabb&) const override {
    return {Interval{-2, 2}, Interval{-2, 2}, Interval{-2, 2}};
  }
  double derivative_bound(int order, const Aabb&) const override {
    return order == 1 ? 4.0 : std::numeric_limits<double>::infinity();
  }
  Aabb bounds() const override {
    const double side = size_;
    return {{0, 0, 0}, {side, side, side}};
  }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<LatticeNoise>(*this);
  }

 private:
  Jet at(const Vec3d& p) const {
    const Vec3d low{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
    const Vec3d t = p - low;
    Jet jet;
    for (int c = 0; c < 8; ++c) {
      const auto weight = [](bool upper, double x) { return upper ? x : 1 - x; };
      const bool ux = c & 1;
      const bool uy = c & 2;
      const bool uz = c & 4;
      const double f = node(static_cast<int>(low.x) + ux, static_cast<int>(low.y) + uy,
                            static_cast<int>(low.z) + uz);
      const double wx = weight(ux, t.x);
      const double wy = weight(uy, t.y);
      const double wz = weight(uz, t.z);
      jet.value += f * (wx * wy * wz);
      jet.gradient +=
          f * Vec3d{(ux ? 1 : -1) * wy * wz, wx * (uy ? 1 : -1) * wz, wx * wy * (uz ? 1 : -1)};
    }
    return jet;
  }

  int size_;
  double share_inside_;
  double smallest_;
  std::uint64_t seed_;
};

}  // namespace cs2mesh::analytic
