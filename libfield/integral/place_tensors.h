// The Taylor series of many places at once. By the binomial series, for a place seen at d,
//     (|d + x|^2 + tau)^-nu = sum_n binomial(-nu, n) S^(-nu - n) (2 d.x + |x|^2)^n,   S = |d|^2 +
//     tau,
// of whose terms those with (d.x)^m |x|^2(n - m) have degree 2n - m. Over many places one needs
//     sum w S^(-nu - n) d^k, |k| = m <= n, 2n - m <= order,
// and the series of all of them once, at the end: a third of the steps of the recurrence in
// taylor_series.h for each place, and fewer the lower the order. Where S > |x|^2 / 0.17 the terms
// add up to few times the field, so that no digits are lost; nearer, what a series leaves out is
// millions of times what they lose.
//
// A lane is one k: those of y^b z^c, sorted by b + c, follow one another. To each n and power a of
// x belongs a range of them, cut into packs; what a pack holds beside the range is not looked at.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "libfield/integral/far_sum.h"
#include "libfield/simd/pack.h"

namespace cs2mesh::detail {

/// The number of products of y and z of lower degree than j.
constexpr int products_below(int j) {
  return j * (j + 1) / 2;
}

/// Which of the sums a series up to `Order` needs, in packs of N.
template <int N, int Order>
struct TensorPlan {
  static_assert(Order <= kTaylorOrder);
  /// The sum, as a lane of a pack, of w S^(-nu - n) d^k, |k| = m, and the place of k.
  struct Sum {
    std::uint16_t lane, place;
    std::uint8_t n, m;
  };
  static constexpr int kProducts = products_below(Order + 1);
  static constexpr int kPacks = (kProducts + N - 1) / N;

  /// The degrees of the products of y and z that belong to n and a; none if they fall.
  static constexpr int least_degree(int n, int a) { return std::max(0, 2 * n - Order - a); }
  static constexpr int most_degree(int n, int a) { return n - a; }
  static constexpr bool needs(int pack, int n, int a) {
    const int least = least_degree(n, a), most = most_degree(n, a);
    return least <= most && products_below(least) < (pack + 1) * N &&
           products_below(most + 1) > pack * N;
  }
  template <class Visit>
  static constexpr void visit(const Visit& visit) {
    for (int pack = 0; pack < kPacks; ++pack) {
      for (int n = 0; n <= Order; ++n) {
        for (int a = 0; a <= n; ++a) {
          if (needs(pack, n, a)) visit(pack, n, a);
        }
      }
    }
  }
  /// Calls visit(lane, j, c) for the products of y and z in a pack that belong to n and a.
  template <class Visit>
  static constexpr void visit_lanes(int pack, int n, int a, const Visit& visit) {
    for (int j = least_degree(n, a); j <= most_degree(n, a); ++j) {
      for (int c = 0; c <= j; ++c) {
        const int lane = products_below(j) + c - pack * N;
        if (lane >= 0 && lane < N) visit(lane, j, c);
      }
    }
  }
  static constexpr std::size_t kSize = [] {
    std::size_t size = 0;
    visit([&](int, int, int) { ++size; });
    return size;
  }();
  static constexpr std::size_t kSums = [] {
    std::size_t size = 0;
    visit([&](int pack, int n, int a) { visit_lanes(pack, n, a, [&](int, int, int) { ++size; }); });
    return size;
  }();

  std::array<std::uint16_t, kSize> factor{};    ///< factor_place(n, a) of each pack of sums
  std::array<std::size_t, kPacks + 1> begin{};  ///< of the sums of each pack of products
  std::array<Sum, kSums> sums{};

  static constexpr int factor_place(int n, int a) { return products_below(n) + a; }

  constexpr TensorPlan() {
    std::size_t i = 0, sum = 0;
    visit([&](int pack, int n, int a) {
      visit_lanes(pack, n, a, [&](int lane, int j, int c) {
        sums[sum++] = {static_cast<std::uint16_t>(i * N + static_cast<std::size_t>(lane)),
                       static_cast<std::uint16_t>(series_index(a, j - c, c)),
                       static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(a + j)};
      });
      factor[i] = static_cast<std::uint16_t>(factor_place(n, a));
      begin[static_cast<std::size_t>(pack) + 1] = ++i;
    });
  }
};
template <int N, int Order>
inline constexpr TensorPlan<N, Order> kTensorPlan{};

/// The sums of a series of the places added; a template of N alone (see pack.h).
template <int N, int Order>
class PlaceTensors {
  using P = Pack<N>;
  static constexpr const TensorPlan<N, Order>& kPlan = kTensorPlan<N, Order>;

 public:
  /// Adds a place a lane; `weight` is w S^-nu.
  void add(const Vec3<P>& d, const P& inverse_s, const P& weight) {
    P* power = factor_;  // w S^(-nu - n) x^a
    for (int n = 0; n <= Order; ++n, power += n) {
      power[0] = n > 0 ? power[-n] * inverse_s : weight;
      for (int a = 1; a <= n; ++a) power[a] = power[a - 1] * d.x;
    }
    product_[0] = P(1);  // y^b z^c: those of y^0 last in their degree
    for (int j = 1; j <= Order; ++j) {
      const P* lower = product_ + products_below(j - 1);
      P* self = product_ + products_below(j);
      for (int i = 0; i < j; ++i) self[i] = lower[i] * d.y;
      self[j] = lower[j - 1] * d.z;
    }
    for (int pack = 0; pack < kPlan.kPacks; ++pack) add_products(pack);
  }

  /// Adds the series of what was added.
  void add_to(double two_nu, double* series) const {
    // By the power of |x|^2, without those powers.
    double part[Order / 2 + 1][kSeriesSize];
    for (int l = 0; l <= Order / 2; ++l) {
      visit_powers([&](int a, int b, int c) { part[l][series_index(a, b, c)] = 0.0; },
                   Order - 2 * l);
    }
    collect(two_nu, part);
    for (int l = Order / 2; l > 0; --l) {
      const auto multiply = [&](int a, int b, int c) {
        const double value = part[l][series_index(a, b, c)];
        part[l - 1][series_index(a + 2, b, c)] += value;
        part[l - 1][series_index(a, b + 2, c)] += value;
        part[l - 1][series_index(a, b, c + 2)] += value;
      };
      visit_powers(multiply, Order - 2 * l);
    }
    visit_powers([&](int a, int b,
                     int c) { series[series_index(a, b, c)] += part[0][series_index(a, b, c)]; },
                 Order);
  }

 private:
  /// Row i of the one is column i of the other: a shuffle of cards, repeated.
  static void transpose(const P* rows, P* columns) {
    using Lanes = std::make_integer_sequence<int, N>;
    for (int i = 0; i < N; ++i) columns[i] = rows[i];
    for (int size = 1; size < N; size *= 2) {
      P next[N];
      for (int i = 0; i < N / 2; ++i) {
        next[2 * i] = shuffled(columns[i], columns[i + N / 2], Zip<N, 1, 0>{}, Lanes{});
        next[2 * i + 1] = shuffled(columns[i], columns[i + N / 2], Zip<N, 1, 1>{}, Lanes{});
      }
      for (int i = 0; i < N; ++i) columns[i] = next[i];
    }
  }

  /// Two chains of steps, or each would wait for the one before.
  void add_products(int pack) {
    P place[N];
    transpose(product_ + pack * N, place);
    const auto at = static_cast<std::size_t>(pack);
    for (std::size_t i = kPlan.begin[at]; i < kPlan.begin[at + 1]; ++i) {
      const P& by = factor_[kPlan.factor[i]];
      P sum = sums_[i], other = P(by.lane[0]) * place[0];
      for (int k = 1; k < N; k += 2) {
        sum = fma(P(by.lane[k]), place[k], sum);
        if (k + 1 < N) other = fma(P(by.lane[k + 1]), place[k + 1], other);
      }
      sums_[i] = sum + other;
    }
  }

  /// Times binomial(-nu, n) binomial(n, m) 2^m m! / k!.
  void collect(double two_nu, double (*part)[kSeriesSize]) const {
    double by[Order + 1][Order + 1];  // by n and m, without 1 / k!
    double all = 1.0;
    for (int n = 0; n <= Order; ++n) {
      if (n > 0) all *= -(0.5 * two_nu + n - 1) / n;
      by[n][0] = all;
      for (int m = 1; m <= n; ++m) by[n][m] = by[n][m - 1] * 2.0 * (n - m + 1);
    }
    for (const auto& sum : kPlan.sums) {
      const double value = sums_[sum.lane / N].lane[sum.lane % N];
      part[sum.n - sum.m][sum.place] += by[sum.n][sum.m] * kInverseFactorials[sum.place] * value;
    }
  }

  P sums_[kPlan.kSize];
  P factor_[products_below(Order + 1)], product_[kPlan.kPacks * N];
};

}  // namespace cs2mesh::detail
