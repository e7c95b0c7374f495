// Value, gradient and second derivative of a scalar function at a point.
#pragma once

#include <cmath>

#include "libfield/base/affine.h"
#include "libfield/base/jet.h"

namespace cs2mesh {

/// A symmetric 3x3 matrix.
template <class T>
struct SymmetricOf {
  T xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

  SymmetricOf& operator+=(const SymmetricOf& m) { return *this = *this + m; }

  friend SymmetricOf operator+(const SymmetricOf& a, const SymmetricOf& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
  }
  friend SymmetricOf operator-(const SymmetricOf& a, const SymmetricOf& b) {
    return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.xz - b.xz, a.yz - b.yz};
  }
  friend SymmetricOf operator*(const T& k, const SymmetricOf& m) {
    return {k * m.xx, k * m.yy, k * m.zz, k * m.xy, k * m.xz, k * m.yz};
  }
  friend Vec3<T> operator*(const SymmetricOf& m, const Vec3<T>& v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
  }
  friend bool operator==(const SymmetricOf&, const SymmetricOf&) = default;
};

using Symmetric3 = SymmetricOf<double>;

/// k times the unit matrix.
template <class T>
constexpr SymmetricOf<T> multiple_of_unit(const T& k) {
  return {k, k, k, T(0), T(0), T(0)};
}

/// a a^T.
template <class T>
SymmetricOf<T> squared(const Vec3<T>& a) {
  return {a.x * a.x, a.y * a.y, a.z * a.z, a.x * a.y, a.x * a.z, a.y * a.z};
}

/// a b^T + b a^T.
template <class T>
SymmetricOf<T> symmetric_product(const Vec3<T>& a, const Vec3<T>& b) {
  return {T(2) * (a.x * b.x),    T(2) * (a.y * b.y),    T(2) * (a.z * b.z),
          a.x * b.y + a.y * b.x, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y};
}

template <class T>
constexpr T trace(const SymmetricOf<T>& m) {
  return m.xx + m.yy + m.zz;
}

/// The Frobenius norm: at least the operator norm, at most sqrt(3) of it.
template <class T>
T norm(const SymmetricOf<T>& m) {
  using std::sqrt;
  return sqrt(m.xx * m.xx + m.yy * m.yy + m.zz * m.zz +
              T(2) * (m.xy * m.xy + m.xz * m.xz + m.yz * m.yz));
}

/// m^T h m, symmetric to the last bit: the second derivative of f(m p), h that of f.
inline Symmetric3 congruent(const Symmetric3& h, const Mat3& m) {
  const Mat3 columns = transpose(m);
  const Vec3d x = h * columns.row[0], y = h * columns.row[1], z = h * columns.row[2];
  return {dot(columns.row[0], x), dot(columns.row[1], y), dot(columns.row[2], z),
          dot(columns.row[0], y), dot(columns.row[0], z), dot(columns.row[1], z)};
}

template <class T>
struct Jet2Of {
  T value{};
  Vec3<T> gradient{};
  SymmetricOf<T> hessian{};

  Jet2Of& operator+=(const Jet2Of& other) {
    value += other.value;
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
  friend Jet2Of operator+(const Jet2Of& a, const Jet2Of& b) { return Jet2Of(a) += b; }
  friend Jet2Of operator*(const T& k, const Jet2Of& jet) {
    return {k * jet.value, k * jet.gradient, k * jet.hessian};
  }
  /// That of the product of two functions.
  friend Jet2Of operator*(const Jet2Of& f, const Jet2Of& g) {
    return {f.value * g.value, f.value * g.gradient + g.value * f.gradient,
            f.value * g.hessian + g.value * f.hessian + symmetric_product(f.gradient, g.gradient)};
  }
  friend bool operator==(const Jet2Of&, const Jet2Of&) = default;
};

using Jet2 = Jet2Of<double>;

/// That of f(m p + t), `jet` that of f at m p + t.
inline Jet2 pulled_back(const Jet2& jet, const Mat3& m) {
  return {jet.value, transpose(m) * jet.gradient, congruent(jet.hessian, m)};
}

}  // namespace cs2mesh
