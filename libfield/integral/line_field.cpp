#include "libfield/integral/line_field.h"

#include <cmath>
#include <numbers>

#include "libfield/base/check.h"
#include "libfield/integral/hessian.h"
#include "libfield/integral/integral.h"

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;
const double kLogRootPi = 0.5 * std::log(kPi);

/// For a support of 1: x is along y, and nothing of the kernel reaches the ends.
template <class K>
LineField across_segment(const K& kernel, double x) {
  const Segment line{{-2, 0, 0}, {2, 0, 0}};
  const Vec3d p{0, x, 0};
  const Jet jet = integral(kernel, line, p);
  return {jet.value, jet.gradient.y, hessian(kernel, line, p).yy};
}

}  // namespace

LineField line_field(KernelKind kind, double x) {
  switch (kind) {
    case KernelKind::cauchy: {
      const double q = 1 / (1 + x * x);
      const double value = 0.5 * kPi * q * std::sqrt(q);
      return {value, -3 * x * q * value, 3 * q * (5 * x * x * q - 1) * value};
    }
    case KernelKind::gaussian: {
      const double value = std::exp(log_line_field(kind, x));
      return {value, -2 * x * value, (4 * x * x - 2) * value};
    }
    case KernelKind::squared:
      return {kPi / x, -kPi / (x * x), 2 * kPi / (x * x * x)};
    case KernelKind::metaball:
      return across_segment(Metaball{1.0}, x);
    case KernelKind::soft:
      return across_segment(Soft{1.0}, x);
    case KernelKind::quartic:
      return across_segment(Quartic{1.0}, x);
    case KernelKind::inverse:
      break;
  }
  require(false, "the inverse kernel diverges on an infinite line");
  return {};
}

double log_line_field(KernelKind kind, double x) {
  return kind == KernelKind::gaussian ? kLogRootPi - x * x : std::log(line_field(kind, x).value);
}

}  // namespace cs2mesh
