#include "libfield/field/pieces.h"

#include <cmath>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

std::pair<Primitive, Primitive> halved(const Segment& segment) {
  const Vec3d middle = 0.5 * (segment.a + segment.b);
  return {Segment{segment.a, middle}, Segment{middle, segment.b}};
}

std::pair<Primitive, Primitive> halved(const Arc& arc) {
  Arc first = arc, second = arc;
  first.sweep = second.sweep = 0.5 * arc.sweep;
  const double c = std::cos(0.25 * arc.sweep), s = std::sin(0.25 * arc.sweep);
  first.ex = c * arc.ex - s * arc.ey;
  first.ey = s * arc.ex + c * arc.ey;
  second.ex = c * arc.ex + s * arc.ey;
  second.ey = c * arc.ey - s * arc.ex;
  return {first, second};
}

std::pair<Primitive, Primitive> halved(const Triangle& triangle) {
  const auto& v = triangle.vertex;
  std::size_t longest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = squared_norm(v[(i + 1) % 3] - v[i]);
    if (length > most) {
      most = length;
      longest = i;
    }
  }
  const Vec3d &a = v[longest], &b = v[(longest + 1) % 3], &c = v[(longest + 2) % 3];
  const Vec3d middle = 0.5 * (a + b);
  return {Triangle{{a, middle, c}}, Triangle{{middle, b, c}}};
}

template <class P>
std::pair<Primitive, Primitive> halved(const P& /*primitive*/) {
  require(false, "halves: not of this primitive");
  return {};
}

}  // namespace

bool can_be_halved(const Term& term) {
  return term.profiles.empty() && (std::holds_alternative<Segment>(term.primitive) ||
                                   std::holds_alternative<Arc>(term.primitive) ||
                                   std::holds_alternative<Triangle>(term.primitive));
}

std::pair<Term, Term> halves(const Term& term) {
  const auto parts = std::visit([](const auto& p) { return halved(p); }, term.primitive);
  std::pair<Term, Term> both{term, term};
  both.first.primitive = parts.first;
  both.first.frame = frame_of(parts.first);
  both.second.primitive = parts.second;
  both.second.frame = frame_of(parts.second);
  return both;
}

}  // namespace cs2mesh
