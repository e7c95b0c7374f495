#include "libfield/integral/far_reach.h"

#include <algorithm>

namespace cs2mesh {
namespace {

/// t'^2.
double turn2(int m) {
  return 1.0 - 4.0 / (static_cast<double>(m) * m);
}

}  // namespace

FarTerms far_terms(double two_nu) {
  FarTerms terms;
  for (int m = 1; m <= kTaylorOrder + 1; ++m) {
    FarTerm& term = terms[static_cast<std::size_t>(m)];
    term.step = (m + two_nu - 1) / m * (1 + 1e-15);
    if (m < 3) continue;
    term.rest = std::max(1.0, (m + two_nu) / (m + 1));
    term.turn = std::pow(turn2(m), -0.5 * m) * (1 + 1e-12);
    if (two_nu == 4.0) {
      // sqrt(a^2 + b) <= a + b / (2 a).
      term.alone = m + 2, term.cot2 = 0.5 / (m + 2);
    } else {
      term.alone = two_nu == 2.0 ? 1.0 : std::sqrt(2 / (std::numbers::pi * (m + 0.5)));
    }
  }
  return terms;
}

double far_share(double two_nu, int m, double c2) {
  if (!(c2 < turn2(m))) return 1.0;
  double binomial = 1.0;
  for (int k = 1; k <= m; ++k) binomial *= (k + two_nu - 1) / k;
  const FarTerm term = far_terms(two_nu)[static_cast<std::size_t>(m)];
  const double over = 1 / (1 - c2);
  const double factor = two_nu == 4.0   ? 0.5 * over
                        : two_nu == 2.0 ? std::sqrt(over)
                                        : std::sqrt(std::sqrt(over));
  const double at_c = factor * (term.alone + term.cot2 * c2 * over) / binomial;
  const double ahead = std::pow(c2, 0.5 * m) * term.turn;
  return std::min(1.0, std::max(at_c, ahead) * (1 + 1e-12));
}

}  // namespace cs2mesh
