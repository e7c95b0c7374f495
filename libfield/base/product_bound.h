// The product of two upper bounds of what is not negative.
#pragma once

namespace cs2mesh {

/// a b, rounded up; 0 where one of them is, though the other be infinite.
inline double product_bound(double a, double b) {
  return a == 0 || b == 0 ? 0.0 : a * b * (1 + 1e-14);
}

}  // namespace cs2mesh
