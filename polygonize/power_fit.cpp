#include "polygonize/power_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

bool has_logarithm(double value) {
  return std::isfinite(value) && value > 0;
}

}  // namespace

std::optional<PowerFit> fit_power(std::span<const double> x, std::span<const double> y) {
  require(x.size() == y.size(), "fit_power: as many x as y");
  std::vector<std::pair<double, double>> logarithms;
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!has_logarithm(x[i]) || !has_logarithm(y[i])) continue;
    logarithms.emplace_back(std::log(x[i]), std::log(y[i]));
    mean_x += logarithms.back().first;
    mean_y += logarithms.back().second;
  }
  const auto count = static_cast<double>(logarithms.size());
  const auto [least, most] = std::minmax_element(logarithms.begin(), logarithms.end());
  if (logarithms.empty() || most->first - least->first < std::log(kLeastSpan)) return std::nullopt;
  mean_x /= count;
  mean_y /= count;

  double xx = 0, xy = 0, yy = 0;
  for (const auto& [u, v] : logarithms) {
    xx += (u - mean_x) * (u - mean_x);
    xy += (u - mean_x) * (v - mean_y);
    yy += (v - mean_y) * (v - mean_y);
  }
  PowerFit fit;
  fit.points = logarithms.size();
  fit.exponent = xy / xx;
  fit.factor = std::exp(mean_y - fit.exponent * mean_x);
  const double left = std::max(0.0, yy - fit.exponent * xy);
  if (count > 2) fit.deviation = std::sqrt(left / ((count - 2) * xx));
  return fit;
}

}  // namespace cs2mesh
