#include "libfield/field/term.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libfield/base/image_box.h"
#include "libfield/field/term_visit.h"
#include "libfield/integral/bound.h"
#include "libfield/profile/cone_weight.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// sup |w|, wherever the point is.
double largest_weight(const Term& term) {
  if (term.profiles.empty()) return 1.0;
  const bool plane = std::holds_alternative<Plane>(term.primitive);
  const Interval range = plane ? Interval::everything() : Interval(0.0, 1.0);
  return enclose(term.profiles, range, range).magnitude();
}

/// weight * field.
Jet product(const Jet& weight, const Jet& field) {
  return {weight.value * field.value,
          weight.value * field.gradient + field.value * weight.gradient};
}
double product(double weight, double field) {
  return weight * field;
}

/// Whether u along the primitive is all that the profile needs.
template <class P>
bool along_alone(const StrengthProfile& profile) {
  return kHasBulkWeights<typename FrameTypeOf<P>::type> &&
         profile.along_v == ProfileFunction::one && !is_of_cones(profile.along_u);
}

/// The weight at a point, with its gradient.
template <class P>
Jet weight_at(const Term& term, const P& primitive, const StrengthProfile& profile,
              const Vec3d& local) {
  if constexpr (kHasBulkWeights<typename FrameTypeOf<P>::type>) {
    if (along_alone<P>(profile)) {
      return weight<double>(profile, frame_for<P>(term), local);
    }
  }
  const Uv at = uv(chart_of(term, primitive), local);
  const ProfileValue value = evaluate(profile, at.u, at.v);
  return {value.w, value.du * at.grad_u + value.dv * at.grad_v};
}

/// Multiplies fields at points by the profiles; at most kRun of them.
constexpr std::size_t kRun = 64;
template <class P, class Out>
void multiply_by_profiles(const Term& term, const P& primitive, std::span<const Vec3d> local,
                          std::span<Out> fields) {
  using F = typename FrameTypeOf<P>::type;
  std::array<Out, kRun> weights;
  for (const StrengthProfile& profile : term.profiles) {
    if constexpr (kHasBulkWeights<F>) {
      if (local.size() >= kBulkCount && along_alone<P>(profile)) {
        const auto find = std::get<FindWeights<F, Out>>(bulk_table().weight_row<Out>());
        find(profile, frame_for<P>(term), local.data(), weights.data(), local.size());
        for (std::size_t i = 0; i < local.size(); ++i) fields[i] = product(weights[i], fields[i]);
        continue;
      }
    }
    for (std::size_t i = 0; i < local.size(); ++i) {
      fields[i] = product(part_of<Out>(weight_at(term, primitive, profile, local[i])), fields[i]);
    }
  }
}

Jet to_world(const Term& term, const Jet& local) {
  return {local.value, to_world_gradient(term, local.gradient)};
}
double to_world(const Term&, double value) {
  return value;
}

template <class Out>
void add_term(const Term& term, std::span<const Vec3d> points, std::span<Out> sums) {
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    if (!term.to_local && term.profiles.empty()) {
      add_integrals(term, kernel, primitive, term.sign, points, sums);
      return;
    }
    std::array<Vec3d, kRun> local;
    std::array<Out, kRun> fields;
    for (std::size_t first = 0; first < points.size(); first += kRun) {
      const std::size_t n = std::min(kRun, points.size() - first);
      for (std::size_t i = 0; i < n; ++i) {
        local[i] = term.to_local ? (*term.to_local)(points[first + i]) : points[first + i];
        fields[i] = Out{};
      }
      add_integrals(term, kernel, primitive, 1.0, {local.data(), n}, std::span(fields.data(), n));
      multiply_by_profiles(term, primitive, {local.data(), n}, std::span(fields.data(), n));
      for (std::size_t i = 0; i < n; ++i) {
        sums[first + i] += term.sign * to_world(term, fields[i]);
      }
    }
  });
}

}  // namespace

Frame frame_of(const Primitive& primitive) {
  return std::visit(
      [](const auto& p) -> Frame {
        using P = std::decay_t<decltype(p)>;
        using F = typename FrameTypeOf<P>::type;
        if constexpr (std::is_same_v<P, Arc> || std::is_same_v<P, Triangle>) {
          return std::make_shared<const F>(p);
        } else {
          return F(p);
        }
      },
      primitive);
}

void accumulate(const Term& term, std::span<const Vec3d> points, std::span<Jet> sums) {
  add_term(term, points, sums);
}

void accumulate(const Term& term, std::span<const Vec3d> points, std::span<double> sums) {
  add_term(term, points, sums);
}

double magnitude_bound(const Term& term, double distance) {
  const double shrink = term.to_local ? 1 / stretch_bound(inverse(*term.to_local).linear) : 1.0;
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    return largest_weight(term) * derivative_bound(kernel, primitive, 0, distance * shrink);
  });
}

double influence_distance(const Term& term, double epsilon) {
  const double support =
      std::visit([](const auto& kernel) { return kernel.support(); }, term.kernel);
  const double stretch = term.to_local ? stretch_bound(inverse(*term.to_local).linear) : 1.0;
  if (std::isfinite(support)) return support * stretch * (1 + 4 * kEpsilon);

  // Bracket on a grid of factors of 16, from the kernel's own length on, then bisect on a
  // logarithmic scale; the outer end is always safe.
  constexpr double kLeast = 1e-12, kMost = 1e150;
  const auto within = [&](double distance) { return magnitude_bound(term, distance) <= epsilon; };
  const double length = std::visit([](const auto& k) { return k.length_scale(); }, term.kernel);
  const double steps = std::clamp(length * stretch, kLeast, kMost) / kLeast;
  double outer = std::ldexp(kLeast, std::ilogb(steps) / 4 * 4);
  if (within(outer)) {
    while (outer > kLeast && within(outer / 16)) outer /= 16;
  } else {
    while (outer * 16 < kMost && !within(outer)) outer *= 16;
    if (!within(outer)) return kInfinity;
  }
  double inner = outer / 16;
  for (int i = 0; i < 8; ++i) {
    const double middle = std::sqrt(inner * outer);
    (within(middle) ? outer : inner) = middle;
  }
  return outer;
}

Aabb skeleton_box(const Term& term) {
  const Aabb local =
      std::visit([](const auto& primitive) { return bounds(primitive); }, term.primitive);
  if (!term.to_local) return local;
  const Affine to_world = inverse(*term.to_local);
  const auto* plane = std::get_if<Plane>(&term.primitive);
  return plane != nullptr ? bounds(transformed(*plane, to_world)) : image_box(local, to_world);
}

}  // namespace cs2mesh
