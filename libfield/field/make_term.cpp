#include "libfield/field/make_term.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libfield/integral/isolation.h"
#include "libfield/integral/line_field.h"
#include "libfield/profile/cone_weight.h"

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

/// What the field of an element is a sum over.
struct Skeleton {
  std::vector<Primitive> pieces;
  const Polygon* polygon = nullptr;  ///< whose pieces they are, if they are
  std::optional<ConeRadii> cone;
};

/// A primitive of no size is a point, unless the plain integral is asked for (no radius).
Skeleton skeleton_of(const Scene& scene, const Element& element, std::optional<double> radius,
                     bool& degenerate) {
  if (element.kind == ElementKind::polygon) {
    const Polygon& polygon = scene.polygons[static_cast<std::size_t>(element.shape)];
    degenerate = radius && measure(polygon) <= 1e-12 * *radius * *radius;
    if (degenerate) return {{Point{middle(polygon)}}, nullptr, {}};
    return {{polygon.pieces.begin(), polygon.pieces.end()}, &polygon, {}};
  }
  degenerate = radius && is_degenerate(element.skeleton, *radius);
  if (degenerate) {
    return {{Point{std::visit([](const auto& p) { return middle(p); }, element.skeleton)}},
            nullptr,
            {}};
  }
  Skeleton skeleton{{element.skeleton}, nullptr, {}};
  if (element.kind == ElementKind::cone && radius) skeleton.cone = cone_radii(scene, element);
  return skeleton;
}

Isolation isolation_of(KernelKind kind, const Skeleton& skeleton, double radius, double width) {
  if (skeleton.cone) return isolate_line_at_width(kind, radius, width);
  if (skeleton.polygon) return isolate_at_width(kind, *skeleton.polygon, radius, width);
  return isolate_at_width(kind, skeleton.pieces.front(), radius, width);
}

Result<KernelShape> kernel_shape(const Scene& scene, const Element& element,
                                 const Skeleton& skeleton) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  const KernelKind kind = kernel_of(scene, element);
  const std::optional<double> radius = radius_of(scene, element);
  const auto fail = [&](const std::string& needs) {
    return error_at(element.where, "a soft " + std::string(name_of(element.kind)) + " needs a " +
                                       needs + " in surface " + quoted(material.name));
  };
  if (material.width && !material.radius) {
    // The plain convolution integral: c = 1.
    const double length = kernel_length(kind, *material.width);
    return KernelShape{kind, {*material.width, 1.0, 0.0}, length};
  }
  if (!radius) return fail("radius, expected 'radius' or 'width'");
  if (!material.width && !material.blobbiness) {
    return fail("blobbiness, expected 'blobbiness' or 'width'");
  }
  const double width =
      material.width ? *material.width : kernel_width(kind, *radius, *material.blobbiness);
  return KernelShape{kind, isolation_of(kind, skeleton, *radius, width), *radius};
}

/// The weight along a soft cone; none where its size leaves the range of double precision, or a
/// radius the support of the kernel.
std::optional<StrengthProfile> weight_of(const ConeRadii& cone, const KernelShape& shape) {
  const double unit = shape.kind == KernelKind::squared
                          ? shape.radius
                          : kernel_length(shape.kind, shape.isolation.width);
  constexpr double kMostExponent = 600;  // of 709
  const double most = std::max(cone.base, cone.apex) / unit;
  if (!(std::abs(log_line_field(shape.kind, most)) <= kMostExponent)) return std::nullopt;
  return cone_weight(shape.kind, cone.base / unit, cone.apex / unit);
}

int dimension(const Primitive& primitive) {
  return std::visit([](const auto& p) { return std::decay_t<decltype(p)>::kDimension; }, primitive);
}

/// Folds a similarity of factor k into kernel and primitive: with q = M q', the integral over the
/// local primitive is k^-dimension times that over the image, of a kernel k times as wide.
void fold_similarity(std::vector<Primitive>& pieces, KernelShape& shape, const Affine& map,
                     double k) {
  double power = -dimension(pieces.front());
  for (Primitive& piece : pieces) {
    piece = std::visit([&](const auto& p) -> Primitive { return transformed(p, map); }, piece);
  }
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

namespace {

/// What no kernel or no taper allows.
Result<KernelKind> usable_kernel(const Scene& scene, const Element& element) {
  const KernelKind kind = kernel_of(scene, element);
  if (is_singular(kind) && std::holds_alternative<Plane>(element.skeleton)) {
    return error_at(element.where,
                    "the kernel " + quoted(name_of(kind)) +
                        " diverges on a plane, expected one that falls off faster, or a triangle",
                    Failure::unmeshable);
  }
  if (kind == KernelKind::inverse && element.kind == ElementKind::cone) {
    return error_at(element.where,
                    "the kernel 'inverse' diverges on the line of a cone, expected one that falls "
                    "off faster",
                    Failure::unmeshable);
  }
  if (element.taper && kind != KernelKind::cauchy && kind != KernelKind::gaussian) {
    return error_at(element.where, "the kernel " + quoted(name_of(kind)) +
                                       " takes no taper, expected 'cauchy' or 'gaussian'");
  }
  return kind;
}

/// The terms over the pieces of a skeleton, each `like` the others.
std::vector<Term> terms_over(const std::vector<Primitive>& pieces, const Term& like,
                             const KernelShape& shape, double strength) {
  const double size_of_strength = std::abs(strength);
  std::vector<Term> terms;
  for (const Primitive& piece : pieces) {
    Term term = like;
    term.primitive = piece;
    term.frame = frame_of(piece);
    const double length =
        shape.radius > 0 ? shape.radius : std::visit([](const auto& p) { return size(p); }, piece);
    term.kernel =
        make_kernel(shape.kind, shape.isolation.width, shape.isolation.strength * size_of_strength,
                    shape.isolation.log_strength + std::log(size_of_strength), 1e-6 * length);
    term.sign = strength < 0 ? -1.0 : 1.0;
    terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace

Result<MadeTerms> make_terms(const Scene& scene, const Element& element) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  MadeTerms made;
  std::vector<Diagnostic> notes;
  const Result<KernelKind> kind = usable_kernel(scene, element);
  if (!kind) return Result<MadeTerms>::failure(kind.diagnostics());

  const bool plain = material.width && !material.radius;
  bool degenerate = false;
  Skeleton skeleton =
      skeleton_of(scene, element, plain ? std::nullopt : radius_of(scene, element), degenerate);
  if (degenerate) {
    notes.push_back({Severity::note, Failure::none, element.where,
                     std::string(name_of(element.kind)) + " of no size counts as a point"});
  }

  Result<KernelShape> found = kernel_shape(scene, element, skeleton);
  if (!found) return Result<MadeTerms>::failure(found.diagnostics());
  KernelShape shape = *found;
  made.radius = shape.radius;
  Term term;
  term.profiles = material.profiles;
  term.material = element.material;
  if (skeleton.polygon)
    term.chart = std::make_shared<Triangle>(std::get<Triangle>(element.skeleton));
  if (skeleton.cone) {
    const std::optional<StrengthProfile> weight = weight_of(*skeleton.cone, shape);
    if (!weight) {
      return error_at(element.where,
                      "the cone is too stiff, or reaches beyond the support of its kernel, expected"
                      " a blobbiness nearer to 0 or another 'width' in surface " +
                          quoted(material.name));
    }
    term.profiles.push_back(*weight);
  }
  double strength = material.strength;
  if (element.taper && degenerate) {
    strength *= mean(*element.taper);
  } else if (element.taper) {
    const FoldedTaper taper = folded(*element.taper, strength);
    Primitive& piece = skeleton.pieces.front();
    piece = TaperedSegment{std::get<Segment>(piece), taper.weight};
    strength = taper.strength;
  }
  if (strength == 0) return {made, notes};

  // Similarities are folded in, other maps are applied to each point; so are those under a profile
  // of the material, whose coordinates turn with the element.
  const Affine map = world_transform(scene, element);
  const double k = similarity_factor(map.linear);
  if (k > 0 && (material.profiles.empty() || map.is_identity())) {
    fold_similarity(skeleton.pieces, shape, map, k);
    made.radius = shape.radius;
  } else {
    term.to_local = std::make_shared<Affine>(inverse(map));
    made.radius /= stretch_bound(term.to_local->linear);
  }
  made.terms = terms_over(skeleton.pieces, term, shape, strength);
  return {std::move(made), notes};
}

}  // namespace cs2mesh
