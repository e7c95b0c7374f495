// Gauss-Legendre rules in numbers of many digits.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace cs2mesh::wide {

/// The rule of N nodes on [0, 1], by Newton's method on the polynomial.
template <class T, int N>
struct WideRule {
  std::array<T, N> node, weight;

  WideRule() {
    for (int i = 0; i < N; ++i) {
      T x = -std::cos(3.14159265358979 * (i + 0.75) / (N + 0.5));
      T slope;
      for (int step = 0; step < 8; ++step) {
        T before = 1, here = x;
        for (int n = 2; n <= N; ++n) {
          const T next = ((2 * n - 1) * x * here - (n - 1) * before) / n;
          before = here, here = next;
        }
        slope = N * (x * here - before) / (x * x - 1);
        x -= here / slope;
      }
      const auto k = static_cast<std::size_t>(i);
      node[k] = (1 + x) / 2;
      weight[k] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

template <class T, int N>
const WideRule<T, N>& wide_rule() {
  static const WideRule<T, N> rule;
  return rule;
}

}  // namespace cs2mesh::wide
