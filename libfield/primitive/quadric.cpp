#include "libfield/primitive/quadric.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/principal_axes.h"

namespace cs2mesh {
namespace {

constexpr double kNegligible = 1e-12;

double greatest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

double least(const Vec3d& v) {
  return std::min({v.x, v.y, v.z});
}

}  // namespace

Jet2 evaluate(const Quadric& quadric, const Vec3d& p) {
  const Vec3d bent = quadric.square * p;
  return {dot(bent + quadric.linear, p) + quadric.constant, 2.0 * bent + quadric.linear,
          2.0 * quadric.square};
}

Quadric substituted(const Quadric& quadric, const Affine& map) {
  const Jet2 at_origin = evaluate(quadric, map.translation);
  return {congruent(quadric.square, map.linear), transpose(map.linear) * at_origin.gradient,
          at_origin.value, std::nullopt};
}

QuadricForm form_of(const Quadric& quadric) {
  const PrincipalAxes principal = principal_axes(quadric.square);
  QuadricForm form;
  form.axis = principal.axis;
  const double most = greatest(principal.value);
  for (std::size_t i = 0; i < 3; ++i) {
    const double curvature = principal.value[i];
    if (!(std::abs(curvature) > kNegligible * most)) continue;
    form.curvature[i] = curvature;
    form.center -= (0.5 * dot(quadric.linear, form.axis.row[i]) / curvature) * form.axis.row[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double along = dot(quadric.linear, form.axis.row[i]);
    const bool flat = form.curvature[i] == 0.0;
    if (flat && std::abs(along) > kNegligible * norm(quadric.linear)) {
      form.slope += along * form.axis.row[i];
    }
  }
  form.value = evaluate(quadric, form.center).value;
  const double size = std::abs(quadric.constant) + norm(quadric.linear) * norm(form.center) +
                      most * squared_norm(form.center);
  if (std::abs(form.value) <= kNegligible * size) form.value = 0;
  return form;
}

bool has_no_inside(const QuadricForm& form) {
  return form.slope == Vec3d{} && form.value >= 0 && least(form.curvature) >= 0;
}

Aabb bounds(const QuadricForm& form) {
  if (has_no_inside(form)) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d half{kInfinity, kInfinity, kInfinity};
  // sum curvature_i x_i^2 <= -value: where e = sum c_i axis_i, e . x is at most
  // sqrt(-value sum c_i^2 / curvature_i).
  const bool may_be_bounded = form.slope == Vec3d{} && least(form.curvature) >= 0;
  for (std::size_t k = 0; may_be_bounded && k < 3; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double along = form.axis.row[i][k];
      if (along != 0) sum += along * along / form.curvature[i];
    }
    half[k] = std::sqrt(-form.value * sum) * (1 + 1e-12);
  }
  return {form.center - half, form.center + half};
}

double least_radius(const QuadricForm& form) {
  const double most = greatest(form.curvature);
  if (!(most > 0)) return 0.0;
  const double bend = 0.5 * norm(form.slope) / most;
  return bend > 0 ? bend : std::sqrt(std::abs(form.value) / most);
}

}  // namespace cs2mesh
