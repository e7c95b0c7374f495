// The reference values that tests read at run time from the shared folder: $CS2MESH_SHARED, or
// `shared` beside the repository.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "libfield/base/jet.h"

namespace cs2mesh::reference {

inline std::string shared_folder() {
  const char* folder = std::getenv("CS2MESH_SHARED");
  return folder != nullptr ? folder : CS2MESH_SOURCE_DIR "/../shared";
}

/// The cells of a CSV file without its header line; empty if there is no such file.
inline std::vector<std::vector<std::string>> read_csv(const std::string& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    rows.push_back(std::move(cells));
  }
  return rows;
}

/// What a field is at a point, to more digits than double holds.
struct Exact {
  long double value = 0.0L;
  long double gradient[3] = {};
  double hessian_norm = 0.0;
  double scale = 0.0;      ///< the largest distance or size that rounding of inputs acts on
  double condition = 1.0;  ///< longest edge over smallest height of a triangle
};

/// Errors in units of the change that moving the inputs by one part in 2^52 makes.
struct BackwardError {
  double value = 0.0, gradient = 0.0;
};

/// What moving the inputs by one part in one makes of value and gradient, to first order:
/// |gradient| and |Hessian| times the scale that the inputs have.
struct Conditioning {
  double slope, curvature;
};

inline BackwardError backward_error(const Jet& jet, const Exact& exact,
                                    const Conditioning& conditioning) {
  constexpr double kEpsilon = 2.2e-16;
  const double g[3] = {jet.gradient.x, jet.gradient.y, jet.gradient.z};
  long double size = 0.0L, off = 0.0L;
  for (int i = 0; i < 3; ++i) {
    size += exact.gradient[i] * exact.gradient[i];
    off += (g[i] - exact.gradient[i]) * (g[i] - exact.gradient[i]);
  }
  const auto value_size = static_cast<double>(std::abs(exact.value));
  const auto gradient_size = static_cast<double>(std::sqrt(size));
  const auto ratio = [&](double error, double exact_size, double moved) {
    // An exact zero, as outside of a support, allows for nothing but zero.
    if (!(error > 1e-300)) return std::isnan(error) ? HUGE_VAL : 0.0;
    const double unit = kEpsilon * (exact.condition * exact_size + moved);
    return unit > 0.0 ? error / unit : HUGE_VAL;
  };
  return {
      ratio(static_cast<double>(std::abs(jet.value - exact.value)), value_size, conditioning.slope),
      ratio(static_cast<double>(std::sqrt(off)), gradient_size, conditioning.curvature)};
}

inline BackwardError backward_error(const Jet& jet, const Exact& exact) {
  const auto slope =
      static_cast<double>(std::hypot(exact.gradient[0], exact.gradient[1], exact.gradient[2]));
  return backward_error(jet, exact, {slope * exact.scale, exact.hessian_norm * exact.scale});
}

}  // namespace cs2mesh::reference
