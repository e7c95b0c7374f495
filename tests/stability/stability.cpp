// How many digits the closed forms keep in stiff and extreme scenes: for families of random
// configurations, the worst error of value and gradient against the same integral in 33 to 100
// digits, beyond what rounding the inputs alone costs (the backward error of
// tests/oracle/reference.h).
//
//     stability [SVG]
//
// prints a table of the digits lost, writes it as a heat map if asked, and fails where a number is
// not finite or more than four digits are lost. Results beyond 1e250 are checked for sign and
// finiteness alone, as they saturate; results below 1e-250 for being as small.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/integral.h"
#include "libfield/integral/isolation.h"
#include "tests/oracle/reference.h"
#include "tests/unit/integral/wide_arc.h"
#include "tests/unit/integral/wide_triangle.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

constexpr double kMostDigits = 4.0;
constexpr int kSamples = 24;
/// Where the numbers to compare with come from quadrature in many digits, up to a second each.
constexpr int kDearSamples = 4;

/// What a configuration is drawn with; lengths in units of `scale`.
struct Family {
  std::string name;
  double scale = 1.0;   ///< of all lengths
  double offset = 0.0;  ///< of the primitive from the origin, in isolation radii
  double blobbiness = -2.0;
  double shape = 1.0;    ///< smallest over greatest extent of a triangle; sweep / 360 of an arc
  double stretch = 1.0;  ///< size of the primitive in isolation radii
  int place = 0;         ///< 0 anywhere, 1 on the primitive or its axis, 2 far away
};

std::vector<Family> families() {
  std::vector<Family> all;
  const auto add = [&](const std::string& name, const auto& change) {
    Family family;
    family.name = name;
    family.shape = 0.6, family.stretch = 3.0;
    change(family);
    all.push_back(family);
  };
  const auto power = [](int exponent) { return "1e" + std::to_string(exponent); };
  for (const int e : {-12, -6, 0, 6, 12}) {
    add("scale " + power(e), [&](Family& f) { f.scale = std::pow(10.0, e); });
  }
  for (const int e : {3, 6, 9}) {
    add("offset " + power(e) + " R", [&](Family& f) { f.offset = std::pow(10.0, e); });
  }
  for (const int e : {-6, -3, 1, 3, 6}) {
    add("|B| " + power(e), [&](Family& f) { f.blobbiness = -std::pow(10.0, e); });
  }
  for (const int e : {-9, -5, -2}) {
    add("shape " + power(e), [&](Family& f) { f.shape = std::pow(10.0, e); });
  }
  for (const int e : {-6, 6}) {
    add("size " + power(e) + " R", [&](Family& f) { f.stretch = std::pow(10.0, e); });
  }
  add("on it", [](Family& f) { f.place = 1; });
  add("far", [](Family& f) { f.place = 2; });
  add("all of it", [](Family& f) {
    f.scale = 1e-7, f.offset = 1e6, f.blobbiness = -1e3, f.shape = 1e-5, f.stretch = 1e3;
  });
  return all;
}

/// A primitive and a point, drawn for a family.
struct Sample {
  Primitive primitive;
  double radius;
  Vec3d point;
};

Primitive shape_of(std::size_t kind, const Family& family, double size, const Vec3d& origin,
                   Random& random) {
  const Vec3d a = random.direction();
  const Vec3d b = normalized(cross(a, random.direction()));
  switch (kind) {
    case 0:
      return Point{origin};
    case 1:
      return Segment{origin, origin + size * a};
    case 2: {
      Arc arc;
      arc.center = origin;
      arc.radius = size;
      arc.sweep = std::min(1.0, family.shape * random.uniform(0.5, 1.7)) * 2.0 * std::numbers::pi;
      arc.normal = a, arc.ex = b, arc.ey = cross(a, b);
      return arc;
    }
    case 3:
      return Triangle{
          {origin, origin + size * a, origin + size * (random.uniform() * a + family.shape * b)}};
    case 4:
      return Plane{origin, a};
    default:
      return TaperedSegment{{origin, origin + size * a}, {random.uniform(), random.uniform(), 0.0}};
  }
}

/// A point of the primitive.
Vec3d place_on(const Primitive& primitive, Random& random) {
  if (const auto* s = std::get_if<TaperedSegment>(&primitive)) return place_on(s->axis, random);
  if (const auto* s = std::get_if<Segment>(&primitive)) {
    return s->a + random.uniform() * (s->b - s->a);
  }
  if (const auto* arc = std::get_if<Arc>(&primitive)) {
    const double t = random.uniform(-0.5, 0.5) * arc->sweep;
    return arc->center + arc->radius * (std::cos(t) * arc->ex + std::sin(t) * arc->ey);
  }
  if (const auto* t = std::get_if<Triangle>(&primitive)) {
    const double u = random.uniform(), v = (1.0 - u) * random.uniform();
    return t->vertex[0] + u * (t->vertex[1] - t->vertex[0]) + v * (t->vertex[2] - t->vertex[0]);
  }
  return std::visit([](const auto& p) { return middle(p); }, primitive);
}

Sample draw(std::size_t kind, const Family& family, Random& random) {
  Sample sample;
  sample.radius = family.scale;
  const double size = family.scale * family.stretch;
  const Vec3d origin = (family.scale * family.offset) * random.direction();
  sample.primitive = shape_of(kind, family, size, origin, random);
  const Vec3d on = place_on(sample.primitive, random);
  if (family.place == 1) {
    // On the primitive, or on the axis of an arc.
    const auto* arc = std::get_if<Arc>(&sample.primitive);
    const bool axis = arc != nullptr && random.uniform() < 0.5;
    sample.point = axis ? arc->center + random.uniform(-2, 2) * size * arc->normal : on;
  } else {
    const double away = family.place == 2 ? std::pow(10.0, random.uniform(2.0, 6.0))
                                          : std::pow(10.0, random.uniform(-4.0, 0.7));
    const double unit = random.uniform() < 0.7 ? sample.radius : std::max(sample.radius, size);
    sample.point = on + away * unit * random.direction();
  }
  return sample;
}

double scale_of(const Primitive& primitive, const Vec3d& p) {
  double scale = std::visit([](const auto& shape) { return size(shape); }, primitive);
  if (!std::isfinite(scale)) scale = 0.0;
  const auto include = [&](const Vec3d& q) { scale = std::max(scale, norm(p - q)); };
  if (const auto* s = std::get_if<TaperedSegment>(&primitive)) return scale_of(s->axis, p);
  if (const auto* s = std::get_if<Segment>(&primitive)) include(s->a), include(s->b);
  if (const auto* t = std::get_if<Triangle>(&primitive)) {
    for (const Vec3d& v : t->vertex) include(v);
  }
  if (const auto* arc = std::get_if<Arc>(&primitive)) {
    include(arc->center);
    scale = std::max(scale, arc->radius);
  }
  if (const auto* point = std::get_if<Point>(&primitive)) include(point->position);
  if (const auto* plane = std::get_if<Plane>(&primitive)) include(plane->point);
  return scale;
}

double condition_of(const Primitive& primitive) {
  const auto* t = std::get_if<Triangle>(&primitive);
  if (t == nullptr) return 1.0;
  const double longest = size(*t);
  return longest * longest / (2 * measure(*t));
}

/// Digits lost in a cell; infinite where a number is not finite.
double digits_lost(const Jet& jet, const reference::Exact& exact) {
  if (!std::isfinite(jet.value) || !is_finite(jet.gradient)) return HUGE_VAL;
  const long double value = std::abs(exact.value);
  if (value > 1e250L || norm(jet.gradient) > 1e250) return jet.value > 0 ? 0.0 : HUGE_VAL;
  if (value < 1e-250L) return std::abs(jet.value) < 1e-249 ? 0.0 : HUGE_VAL;
  const reference::BackwardError error = reference::backward_error(jet, exact);
  return std::log10(std::max({1.0, error.value, error.gradient}));
}

/// The field in 100 digits where a pair has a form for every number type, else in 33 or more; that
/// of quadrature where a triangle's kernel is cut off.
template <class K, class P>
reference::Exact exact_at(const K& kernel, const P& primitive, const Vec3d& p) {
  const double scale = scale_of(primitive, p), condition = condition_of(primitive);
  if constexpr (std::is_same_v<P, Triangle> && !std::is_same_v<K, Cauchy>) {
    if constexpr (requires { kernel.clamp; }) {
      // Rounding moves the place at the cut-off distance by that share of the distance.
      const double least = std::max(kernel.clamp, 1e-13 * size(primitive));
      if (distance(primitive, p) < least) {
        const Jet jet = quadrature(kernel, primitive, p);
        return {jet.value, {}, 0.0, scale, condition * std::max(1.0, scale / least)};
      }
    }
    return wide::exact_triangle(kernel, primitive, p, scale, condition);
  } else if constexpr (std::is_same_v<P, Arc> &&
                       !requires { integral(kernel, primitive, Vec3<wide::Wide>(p)); }) {
    return wide::exact_arc_field(kernel, primitive, p, scale, condition);
  } else {
    return wide::exact_field(kernel, primitive, p, scale, condition);
  }
}

/// Whether there is no closed form in any number type to compare with.
bool is_dear(KernelKind kind, std::size_t shape) {
  return (shape == 2 || shape == 3) && kind != KernelKind::cauchy;
}

double worst_of(KernelKind kernel_kind, std::size_t shape, const Family& family) {
  double worst = 0.0;
  for (int i = 0; i < (is_dear(kernel_kind, shape) ? kDearSamples : kSamples); ++i) {
    Random random(17, static_cast<std::uint64_t>(i));
    const Sample sample = draw(shape, family, random);
    const Isolation isolation =
        isolate(kernel_kind, sample.primitive, sample.radius, family.blobbiness);
    // What a scene would hold: the strength as long as it is a number.
    const double strength = std::clamp(isolation.strength, 1e-200, 1e200);
    const Kernel kernel = make_kernel(kernel_kind, isolation.width, strength,
                                      isolation.log_strength, 1e-6 * sample.radius);
    worst = std::max(
        worst,
        std::visit(
            [&](const auto& k, const auto& p) {
              if constexpr (kHasField<std::decay_t<decltype(k)>, std::decay_t<decltype(p)>>) {
                const reference::Exact exact = exact_at(k, p, sample.point);
                return digits_lost(testing::accumulated(
                                       testing::plain_term(kernel, sample.primitive), sample.point),
                                   exact);
              } else {
                return 0.0;
              }
            },
            kernel, sample.primitive));
  }
  return worst;
}

bool has_field(KernelKind kind, std::size_t shape) {
  const bool inverse = kind == KernelKind::inverse || kind == KernelKind::squared;
  if (shape == 4) return !inverse;
  return shape != 5 || kind == KernelKind::cauchy || kind == KernelKind::gaussian;
}

struct Row {
  std::string name;
  std::vector<double> digits;
};

/// Cells from green to red by the digits lost.
void write_svg(const std::string& path, const std::vector<Family>& columns,
               const std::vector<Row>& rows) {
  constexpr int kLeft = 150, kTop = 120, kWidth = 46, kHeight = 22;
  std::ofstream out(path);
  out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << kLeft + kWidth * columns.size() + 20
      << "' height='" << kTop + kHeight * rows.size() + 20
      << "' font-family='sans-serif' font-size='11'>\n";
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t x = kLeft + kWidth * c + kWidth / 2;
    out << "<text transform='translate(" << x << "," << kTop - 8 << ") rotate(-60)'>"
        << columns[c].name << "</text>\n";
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t y = kTop + kHeight * r;
    out << "<text x='8' y='" << y + 15 << "'>" << rows[r].name << "</text>\n";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double digits = rows[r].digits[c];
      const double share = std::min(1.0, digits / kMostDigits);
      char cell[256];
      std::snprintf(cell, sizeof cell,
                    "<rect x='%zu' y='%zu' width='%d' height='%d' fill='hsl(%.0f,70%%,%.0f%%)'/>"
                    "<text x='%zu' y='%zu'>%.1f</text>\n",
                    kLeft + kWidth * c, y, kWidth - 2, kHeight - 2, 120 * (1 - share),
                    85 - 25 * share, kLeft + kWidth * c + 12, y + 15, digits);
      out << cell;
    }
  }
  out << "</svg>\n";
}

int run(const char* svg) {
  constexpr std::array<std::string_view, 6> kShapes = {"point",    "segment", "arc",
                                                       "triangle", "plane",   "tapered"};
  const std::vector<Family> columns = families();
  std::printf(
      "digits lost beyond the rounding of the inputs, worst of %d, or of %d where reference values "
      "are dear\n%-18s",
      kSamples, kDearSamples, "");
  for (const Family& family : columns) std::printf(" %s |", family.name.c_str());
  std::printf("\n");
  std::vector<Row> rows;
  int bad = 0;
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t shape = 0; shape < kShapes.size(); ++shape) {
      if (!has_field(kind, shape)) continue;
      Row row{std::string(name_of(kind)) + " " + std::string(kShapes[shape]), {}};
      std::printf("%-18s", row.name.c_str());
      for (const Family& family : columns) {
        const double digits = worst_of(kind, shape, family);
        row.digits.push_back(digits);
        bad += digits <= kMostDigits ? 0 : 1;
        std::printf(" %*.1f |", static_cast<int>(family.name.size()), digits);
      }
      std::printf("\n");
      std::fflush(stdout);
      rows.push_back(row);
    }
  }
  if (svg != nullptr) write_svg(svg, columns, rows);
  if (bad > 0) std::printf("%d cells lose more than %.0f digits\n", bad, kMostDigits);
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace cs2mesh

int main(int argc, char** argv) {
  return cs2mesh::run(argc > 1 ? argv[1] : nullptr);
}
