#include "libfield/solid/quadric_solid.h"

#include <algorithm>
#include <cmath>

#include "libfield/field/quadratic_range.h"

namespace cs2mesh {
namespace {

/// |grad q| where the axis of greatest curvature meets the surface, at the vertex of a paraboloid,
/// or at the distance 1 from the tip of a cone.
double slope_at_vertex(const QuadricForm& form) {
  const Vec3d& c = form.curvature;
  const double most = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  const double slope = norm(form.slope) + 2 * std::sqrt(most * std::abs(form.value));
  return slope > 0 ? slope : 2 * most;
}

}  // namespace

// The polynomial is moved to its center before it is turned and stretched, so that nothing is lost
// where the transform carries it far away.
std::shared_ptr<const QuadricSolid> QuadricSolid::make(const Quadric& quadric,
                                                       const Affine& to_world) {
  const Vec3d center = form_of(quadric).center;
  const Quadric at_center = substituted(quadric, Affine::translate(center));
  const Quadric turned = substituted(at_center, {inverse(to_world.linear), {}});
  QuadricSolid solid;
  solid.form_ = form_of(turned);
  const double slope = slope_at_vertex(solid.form_);
  const Quadric moved = substituted(turned, Affine::translate(solid.form_.center));
  solid.scaled_ = {(-1 / slope) * moved.square, -moved.linear / slope, -moved.constant / slope,
                   std::nullopt};
  solid.form_.center += to_world(center);
  const bool usable = slope > 0 && is_finite(solid.form_.center) &&
                      std::isfinite(norm(solid.scaled_.square)) &&
                      is_finite(solid.scaled_.linear) && std::isfinite(solid.scaled_.constant);
  if (!usable) return nullptr;
  return std::make_shared<const QuadricSolid>(solid);
}

void QuadricSolid::values(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]).value;
}

void QuadricSolid::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Jet2 jet = at(points[i]);
    out[i] = {jet.value, jet.gradient};
  }
}

void QuadricSolid::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]);
}

double QuadricSolid::rounding(double distance) const {
  return 1e-14 * (std::abs(scaled_.constant) +
                  (norm(scaled_.linear) + norm(scaled_.square) * distance) * distance);
}

Interval QuadricSolid::enclose(const Aabb& box) const {
  const Jet2 middle = at(box.center());
  const Interval range = quadratic_range(middle.gradient, middle.hessian, 0.5 * box.extent());
  return widened(range + Interval(middle.value), rounding(box.farthest_distance(form_.center)));
}

std::array<Interval, 3> QuadricSolid::enclose_gradient(const Aabb& box) const {
  const Jet2 middle = at(box.center());
  const Symmetric3& h = middle.hessian;
  const Vec3d half = 0.5 * box.extent();
  const double slack =
      1e-14 * (norm(scaled_.linear) + norm(h) * box.farthest_distance(form_.center));
  const auto component = [&](double g, const Vec3d& row) {
    return widened(Interval(g), extent_along(row, half) + slack);
  };
  return {component(middle.gradient.x, {h.xx, h.xy, h.xz}),
          component(middle.gradient.y, {h.xy, h.yy, h.yz}),
          component(middle.gradient.z, {h.xz, h.yz, h.zz})};
}

double QuadricSolid::derivative_bound(int order, const Aabb& box) const {
  if (order > 2) return 0.0;
  const Jet2 middle = at(box.center());
  const double curvature = norm(middle.hessian) * (1 + 1e-14);
  if (order == 2) return curvature;
  const double slack =
      1e-14 * (norm(scaled_.linear) + curvature * box.farthest_distance(form_.center));
  return norm(middle.gradient) + 0.5 * curvature * box.diagonal() + slack;
}

Aabb QuadricSolid::bounds() const {
  return cs2mesh::bounds(form_);
}

std::unique_ptr<ImplicitSurface> QuadricSolid::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<QuadricSolid>(*this);
}

}  // namespace cs2mesh
