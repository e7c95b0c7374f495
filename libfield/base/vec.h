// Vectors of three components over any number type.
#pragma once

#include <cmath>
#include <cstddef>

namespace cs2mesh {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  /// Conversion between number types is explicit: it may round.
  template <class U>
  explicit constexpr Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

  constexpr const T& operator[](std::size_t axis) const {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr T& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr Vec3& operator+=(const Vec3& v) { return *this = *this + v; }
  constexpr Vec3& operator-=(const Vec3& v) { return *this = *this - v; }
  constexpr Vec3& operator*=(const T& k) { return *this = *this * k; }

  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(const Vec3& a, const T& k) { return {a.x * k, a.y * k, a.z * k}; }
  friend constexpr Vec3 operator*(const T& k, const Vec3& a) { return a * k; }
  friend constexpr Vec3 operator/(const Vec3& a, const T& k) { return {a.x / k, a.y / k, a.z / k}; }
  friend constexpr bool operator==(const Vec3& a, const Vec3& b) = default;
};

using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The axis along which it is longest, the first of them.
constexpr std::size_t longest_axis(const Vec3<double>& extent) {
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}
template <class T>
constexpr T squared_norm(const Vec3<T>& a) {
  return dot(a, a);
}

/// Euclidean length. Squares overflow beyond about 1e154 and underflow below about 1e-154.
template <class T>
T norm(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(squared_norm(a));
}

/// The unit vector along `a`; `a` itself must not be zero.
template <class T>
Vec3<T> normalized(const Vec3<T>& a) {
  return a / norm(a);
}

/// Component-wise minimum and maximum.
template <class T>
constexpr Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
template <class T>
constexpr Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

inline bool is_finite(const Vec3d& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace cs2mesh
