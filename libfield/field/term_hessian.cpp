// The second derivative of terms: that of the integral, by the product rule with each profile, as
// seen from the scene.
#include "libfield/field/term.h"
#include "libfield/field/term_visit.h"
#include "libfield/integral/hessian.h"
#include "libfield/primitive/uv_hessian.h"
#include "libfield/profile/profile_hessian.h"

namespace cs2mesh {
namespace {

/// w(u, v) by the chain rule.
template <class P>
Jet2 weight_at(const StrengthProfile& profile, const P& primitive, const Vec3d& local) {
  const Uv at = uv(primitive, local);
  const UvHessian bend = uv_hessian(primitive, local);
  const ProfileValue first = evaluate(profile, at.u, at.v);
  const ProfileHessian second = profile_hessian(profile, at.u, at.v);
  return {first.w, first.du * at.grad_u + first.dv * at.grad_v,
          second.uu * squared(at.grad_u) + second.uv * symmetric_product(at.grad_u, at.grad_v) +
              second.vv * squared(at.grad_v) + first.du * bend.u + first.dv * bend.v};
}

template <class K, class P>
Symmetric3 local_hessian(const Term& term, const K& kernel, const P& primitive,
                         const Vec3d& local) {
  if (term.profiles.empty()) return hessian(kernel, primitive, local);
  const Jet jet = integral_of(term, kernel, primitive, local);
  Jet2 field{jet.value, jet.gradient, hessian(kernel, primitive, local)};
  for (const StrengthProfile& profile : term.profiles) {
    field = weight_at(profile, chart_of(term, primitive), local) * field;
  }
  return field.hessian;
}

}  // namespace

void accumulate(const Term& term, std::span<const Vec3d> points, std::span<Symmetric3> sums) {
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d local = term.to_local ? (*term.to_local)(points[i]) : points[i];
      const Symmetric3 h = local_hessian(term, kernel, primitive, local);
      sums[i] += term.sign * (term.to_local ? congruent(h, term.to_local->linear) : h);
    }
  });
}

}  // namespace cs2mesh
