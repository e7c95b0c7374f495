#include "libfield/field/make_term.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/integral/isolation.h"

namespace cs2mesh {
namespace {

std::string quoted(std::string_view word) {
  return "'" + std::string(word) + "'";
}

bool is_singular(KernelKind kind) {
  return kind == KernelKind::inverse || kind == KernelKind::squared;
}

/// What shape a soft element's kernel takes, in the element's own coordinates.
struct KernelShape {
  KernelKind kind;
  Isolation isolation;
  double radius = 0.0;  ///< R, or the kernel's own length where no R is in force
};

double kernel_length(KernelKind kind, double width) {
  switch (kind) {
    case KernelKind::cauchy:
    case KernelKind::gaussian:
      return 1 / width;
    case KernelKind::inverse:
    case KernelKind::squared:
      return 0;
    default:
      return width;
  }
}

Result<KernelShape> kernel_shape(const Scene& scene, const Element& element,
                                 const Primitive& primitive) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  const KernelKind kind = kernel_of(scene, element);
  const std::optional<double> radius = radius_of(scene, element);
  const auto fail = [&](const std::string& message) {
    return error_at(element.where, message + " in surface " + quoted(material.name));
  };
  if (material.width && !material.radius) {
    // The plain convolution integral: c = 1.
    const double length = kernel_length(kind, *material.width);
    return KernelShape{kind, {*material.width, 1.0, 0.0}, length};
  }
  if (!radius) {
    return fail("a soft " + std::string(name_of(element.kind)) +
                " needs a radius, expected 'radius' or 'width'");
  }
  if (material.width) {
    return KernelShape{kind, isolate_at_width(kind, primitive, *radius, *material.width), *radius};
  }
  if (!material.blobbiness) {
    return fail("a soft " + std::string(name_of(element.kind)) +
                " needs a blobbiness, expected 'blobbiness' or 'width'");
  }
  return KernelShape{kind, isolate(kind, primitive, *radius, *material.blobbiness), *radius};
}

Primitive as_point_if_degenerate(const Primitive& primitive, double radius, bool& changed) {
  changed = is_degenerate(primitive, radius);
  if (!changed) return primitive;
  return Point{std::visit([](const auto& p) { return middle(p); }, primitive)};
}

int dimension(const Primitive& primitive) {
  return std::visit([](const auto& p) { return std::decay_t<decltype(p)>::kDimension; }, primitive);
}

/// Folds a similarity of factor k into kernel and primitive: with q = M q', the integral over the
/// local primitive is k^-dimension times that over the image, of a kernel k times as wide.
void fold_similarity(Term& term, KernelShape& shape, const Affine& map, double k) {
  const int dim = dimension(term.primitive);
  term.primitive =
      std::visit([&](const auto& p) -> Primitive { return transformed(p, map); }, term.primitive);
  double power = -dim;
  switch (shape.kind) {
    case KernelKind::cauchy:
    case KernelKind::gaussian:
      shape.isolation.width /= k;
      break;
    case KernelKind::inverse:
      power += 1;
      break;
    case KernelKind::squared:
      power += 2;
      break;
    default:
      shape.isolation.width *= k;
  }
  shape.isolation.strength *= std::pow(k, power);
  shape.isolation.log_strength += power * std::log(k);
  shape.radius *= k;
}

/// The weight of a taper and the strength of its element as a term holds them.
struct FoldedTaper {
  SegmentWeight weight;
  double strength;
};

/// The size of the weight goes into the strength, so that weights of any size compute like those of
/// size 1 (a power of two: nothing is rounded). Signs move so that the field of a term of negative
/// strength is nowhere positive, which the bounds of the surface rely on.
FoldedTaper folded(const SegmentWeight& w, double strength) {
  const double greatest = std::max({std::abs(w.b0), std::abs(w.b1), std::abs(w.b2)});
  if (!(greatest > 0)) return {w, 0.0};
  const bool none_positive = std::max({w.b0, w.b1, w.b2}) <= 0;
  const bool some_negative = std::min({w.b0, w.b1, w.b2}) < 0;
  const double sign = none_positive || (strength < 0 && some_negative) ? -1.0 : 1.0;
  const double unit = sign * std::ldexp(1.0, std::ilogb(greatest));
  return {{w.b0 / unit, w.b1 / unit, w.b2 / unit}, strength * unit};
}

}  // namespace

bool is_degenerate(const Primitive& primitive, double radius) {
  const int dim = dimension(primitive);
  if (dim == 0) return false;
  const double mass = std::visit([](const auto& p) { return measure(p); }, primitive);
  return mass <= 1e-12 * std::pow(radius, dim);
}

Result<MadeTerm> make_term(const Scene& scene, const Element& element) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  MadeTerm made;
  std::vector<Diagnostic> notes;
  const KernelKind kind = kernel_of(scene, element);
  if (element.kind == ElementKind::cone) {
    notes.push_back({Severity::warning, Failure::none, element.where,
                     "a soft cone is left out, expected a surface without 'blobbiness', or a "
                     "cylinder with 'taper'"});
    return {std::move(made), std::move(notes)};
  }
  if (is_singular(kind) && std::holds_alternative<Plane>(element.skeleton)) {
    return error_at(element.where,
                    "the kernel " + quoted(name_of(kind)) +
                        " diverges on a plane, expected one that falls off faster, or a triangle",
                    Failure::unmeshable);
  }

  if (element.taper && kind != KernelKind::cauchy && kind != KernelKind::gaussian) {
    return error_at(element.where, "the kernel " + quoted(name_of(kind)) +
                                       " takes no taper, expected 'cauchy' or 'gaussian'");
  }

  // A primitive of no size is a point, unless the plain integral is asked for.
  Term term;
  bool degenerate = false;
  const std::optional<double> radius = radius_of(scene, element);
  const bool plain = material.width && !material.radius;
  term.primitive = plain || !radius ? element.skeleton
                                    : as_point_if_degenerate(element.skeleton, *radius, degenerate);
  if (degenerate) {
    notes.push_back({Severity::note, Failure::none, element.where,
                     std::string(name_of(element.kind)) + " of no size counts as a point"});
  }

  Result<KernelShape> found = kernel_shape(scene, element, term.primitive);
  if (!found) return Result<MadeTerm>::failure(found.diagnostics());
  KernelShape shape = *found;
  made.radius = shape.radius;
  double strength = material.strength;
  if (element.taper && degenerate) {
    strength *= mean(*element.taper);
  } else if (element.taper) {
    const FoldedTaper taper = folded(*element.taper, strength);
    term.primitive = TaperedSegment{std::get<Segment>(term.primitive), taper.weight};
    strength = taper.strength;
  }
  if (strength == 0) return {made, notes};

  // Similarities are folded in, other maps are applied to each point; so are those under a profile,
  // whose coordinates turn with the element.
  const Affine map = world_transform(scene, element);
  const double k = similarity_factor(map.linear);
  if (k > 0 && (material.profiles.empty() || map.is_identity())) {
    fold_similarity(term, shape, map, k);
    made.radius = shape.radius;
  } else {
    term.to_local = inverse(map);
    made.radius /= stretch_bound(term.to_local->linear);
  }

  const double size_of_strength = std::abs(strength);
  const double clamp =
      1e-6 * (shape.radius > 0 ? shape.radius
                               : std::visit([](const auto& p) { return size(p); }, term.primitive));
  term.kernel =
      make_kernel(shape.kind, shape.isolation.width, shape.isolation.strength * size_of_strength,
                  shape.isolation.log_strength + std::log(size_of_strength), clamp);
  term.frame = frame_of(term.primitive);
  term.sign = strength < 0 ? -1.0 : 1.0;
  term.profiles = material.profiles;
  term.material = element.material;
  made.term = std::move(term);
  return {std::move(made), notes};
}

}  // namespace cs2mesh
