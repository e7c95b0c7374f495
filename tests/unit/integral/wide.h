// Tools of the closed forms' tests: a wide number type, and the perturbation that rounding the
// inputs of a closed form makes, computed with it.
#pragma once

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/expm1.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <functional>

#include "libfield/base/jet.h"
#include "tests/oracle/reference.h"

namespace cs2mesh::wide {

/// Twice the digits that results need: closed forms in it lose digits where the double versions
/// switch their form.
using Wide = boost::multiprecision::cpp_bin_float_100;

/// Value, gradient and |Hessian| at `point` of field(p), p and the jet in numbers T; the last by
/// differences of the gradient over `step` times the scale.
template <class T, class Field>
reference::Exact exact_of(const Field& field, const Vec3d& point, double scale, double condition,
                          const T& step_per_scale) {
  const Vec3<T> p(point);
  const JetOf<T> jet = field(p);
  const T step = T(scale) * step_per_scale;
  T hessian = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3<T> moved = p;
    moved[axis] += step;
    hessian += squared_norm(Vec3<T>((field(moved).gradient - jet.gradient) / step));
  }
  reference::Exact exact;
  exact.value = static_cast<long double>(jet.value);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    exact.gradient[axis] = static_cast<long double>(jet.gradient[axis]);
  }
  exact.hessian_norm = static_cast<double>(sqrt(hessian));
  exact.scale = scale;
  exact.condition = condition;
  return exact;
}

/// The same of a closed form.
template <class Kernel, class Primitive>
reference::Exact exact_field(const Kernel& kernel, const Primitive& primitive, const Vec3d& point,
                             double scale, double condition) {
  return exact_of<Wide>([&](const Vec3<Wide>& p) { return integral(kernel, primitive, p); }, point,
                        scale, condition, Wide("1e-35"));
}

/// The greatest difference of the gradient and central differences of the value, relative to the
/// gradient.
template <class Kernel, class Primitive>
double gradient_mismatch(const Kernel& kernel, const Primitive& primitive, const Vec3d& point,
                         double scale) {
  const Vec3<Wide> p(point);
  const JetOf<Wide> jet = integral(kernel, primitive, p);
  const Wide step = Wide(scale) * Wide("1e-20");
  Wide worst = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3<Wide> before = p, after = p;
    before[axis] -= step;
    after[axis] += step;
    const Wide rise =
        integral(kernel, primitive, after).value - integral(kernel, primitive, before).value;
    worst = (std::max)(worst, Wide(abs(rise / (2 * step) - jet.gradient[axis])));
  }
  const Wide size = norm(jet.gradient);
  return size > 0 ? static_cast<double>(worst / size) : static_cast<double>(worst);
}

}  // namespace cs2mesh::wide
