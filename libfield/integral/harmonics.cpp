#include "libfield/integral/harmonics.h"

#include <cstdint>
#include <vector>

namespace cs2mesh {
namespace {

/// N_lm.
double addition_factor(int l, int m) {
  double factor = m == 0 ? 1.0 : 2.0;
  for (int k = 1; k <= l; ++k) {
    const double ratio = (2.0 * k - 1.0) / k;
    factor *= ratio * ratio;
  }
  for (int k = 1; k <= m; ++k) factor *= (l + 1.0 - k) / (l + k);
  return factor;
}

/// Adds factor times a polynomial of degree l, its power of x, y or z raised by the shift.
void add_shifted(double factor, const Series& from, int l, int x, int y, int z, Series& to) {
  for (int a = 0; a <= l; ++a) {
    for (int b = 0; a + b <= l; ++b) {
      const int c = l - a - b;
      to[series_index(a + x, b + y, c + z)] += factor * from[series_index(a, b, c)];
    }
  }
}

/// The harmonics of degree l as polynomials, from those of the two degrees below.
std::vector<Series> next_harmonics(int l, const std::vector<Series>& last,
                                   const std::vector<Series>& before) {
  std::vector<Series> self(static_cast<std::size_t>(harmonics_of(l)), Series{});
  for (std::size_t i = 0; i < last.size(); ++i) add_shifted(1.0, last[i], l - 1, 0, 0, 1, self[i]);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double step = -harmonic_step(l, static_cast<int>(i + 1) / 2);
    add_shifted(step, before[i], l - 2, 2, 0, 0, self[i]);
    add_shifted(step, before[i], l - 2, 0, 2, 0, self[i]);
    add_shifted(step, before[i], l - 2, 0, 0, 2, self[i]);
  }
  // (x + i y) times the last pair, of which that of l = 1 has no sine.
  Series& cosine = self[self.size() - 2];
  Series& sine = self[self.size() - 1];
  const Series& last_cosine = last[l > 1 ? last.size() - 2 : 0];
  add_shifted(1.0, last_cosine, l - 1, 1, 0, 0, cosine);
  add_shifted(1.0, last_cosine, l - 1, 0, 1, 0, sine);
  if (l > 1) {
    add_shifted(-1.0, last.back(), l - 1, 0, 1, 0, cosine);
    add_shifted(1.0, last.back(), l - 1, 1, 0, 0, sine);
  }
  return self;
}

/// N_lm Q_lm as powers of x, y and z.
struct HarmonicTable {
  struct Monomial {
    std::uint16_t place;
    double factor;
  };
  struct Row {
    int l, i;
    std::vector<Monomial> monomials;
  };
  std::vector<Row> rows;

  HarmonicTable() {
    std::vector<Series> before, last, self{Series{}};
    self[0][series_index(0, 0, 0)] = 1.0;
    for (int l = 0; l <= kTaylorOrder; ++l) {
      if (l > 0) {
        before = std::move(last);
        last = std::move(self);
        self = next_harmonics(l, last, before);
      }
      for (int i = 0; i < harmonics_of(l); ++i) add_row(l, i, self[static_cast<std::size_t>(i)]);
    }
  }

  void add_row(int l, int i, const Series& harmonic) {
    Row row{l, i, {}};
    for (std::size_t k = 0; k < kSeriesSize; ++k) {
      if (harmonic[k] == 0.0) continue;
      row.monomials.push_back(
          {static_cast<std::uint16_t>(k), addition_factor(l, (i + 1) / 2) * harmonic[k]});
    }
    rows.push_back(std::move(row));
  }
};

}  // namespace

void add_harmonics(const HarmonicSums& sums, Series& series) {
  static const HarmonicTable table;
  // By the power of |x|^2, without those powers.
  std::array<Series, kTaylorOrder / 2 + 1> part;
  for (Series& some : part) some.fill(0.0);
  for (const auto& [l, i, monomials] : table.rows) {
    const double* factor = sums.data() + harmonic_index(l, i, 0);
    for (int j = 0; j < radial_powers(l); ++j) {
      Series& to = part[static_cast<std::size_t>(j)];
      for (const auto& monomial : monomials) to[monomial.place] += monomial.factor * factor[j];
    }
  }
  for (std::size_t j = part.size() - 1; j > 0; --j) {
    const auto multiply = [&](int a, int b, int c) {
      const double value = part[j][series_index(a, b, c)];
      part[j - 1][series_index(a + 2, b, c)] += value;
      part[j - 1][series_index(a, b + 2, c)] += value;
      part[j - 1][series_index(a, b, c + 2)] += value;
    };
    visit_powers(multiply, kTaylorOrder - 2 * static_cast<int>(j));
  }
  for (std::size_t k = 0; k < kSeriesSize; ++k) series[k] += part[0][k];
}

}  // namespace cs2mesh
