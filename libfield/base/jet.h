// Value and gradient of a scalar function at a point.
#pragma once

#include "libfield/base/vec.h"

namespace cs2mesh {

template <class T>
struct JetOf {
  T value{};
  Vec3<T> gradient{};

  JetOf& operator+=(const JetOf& other) {
    value += other.value;
    gradient += other.gradient;
    return *this;
  }
  friend JetOf operator*(const T& k, const JetOf& jet) { return {k * jet.value, k * jet.gradient}; }
  friend bool operator==(const JetOf&, const JetOf&) = default;
};

using Jet = JetOf<double>;

}  // namespace cs2mesh
