// Primitives: what stands in the text becomes a skeleton, nothing is evaluated.
#include <algorithm>
#include <variant>

#include "libfield/art/commands.h"

namespace cs2mesh::commands {
namespace {

Segment read_segment(Arguments& args) {
  const Vec3d base = args.triple("the base, x y z");
  const Vec3d apex = args.triple("the apex, x y z");
  return {base, apex};
}

/// [taper W0 W1 [WMID]]: weights at the base, at the apex and in the middle.
std::optional<SegmentWeight> read_taper(Arguments& args) {
  if (!args.take_if("taper", 2)) return std::nullopt;
  const double base = args.number("the weight at the base");
  const double apex = args.number("the weight at the apex");
  if (!args.more()) return linear_weight(base, apex);
  return quadratic_weight(base, args.number("the weight in the middle"), apex);
}

void rod(SceneBuilder& builder, Arguments& args, Spelling spelling) {
  const int material = builder.read_material(args);
  const double radius = args.positive("the radius");
  const Segment axis = read_segment(args);
  const std::optional<SegmentWeight> taper = read_taper(args);
  builder.add(args, ElementKind::cylinder, axis, material, radius, spelling, taper);
}

void point(SceneBuilder& builder, Arguments& args, ElementKind kind) {
  const int material = builder.read_material(args);
  const Vec3d position = args.triple("the position, x y z");
  builder.add(args, kind, Point{position}, material);
}

/// Two opposite corners, sorted; fails where they are not.
Aabb read_box(Arguments& args) {
  const Vec3d one = args.triple("a corner, x y z");
  const SourceLocation where = args.here();
  const Vec3d other = args.triple("the opposite corner, x y z");
  const Aabb box{min(one, other), max(one, other)};
  const Vec3d extent = box.extent();
  if (!args.failed() && !(std::min({extent.x, extent.y, extent.z}) > 0)) {
    args.fail(where, "a box without volume, expected a corner that differs in x, y and z");
  }
  return box;
}

Vec3d read_coefficients(Arguments& args, std::string_view names) {
  return args.triple("the coefficients of " + std::string(names));
}

}  // namespace

void box(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const Aabb box = read_box(args);
  builder.add(args, ElementKind::box, Segment{box.min, box.max}, material);
}

void brick(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const double x = args.positive("the side along x");
  const double y = args.positive("the side along y");
  const double z = args.positive("the side along z");
  const Vec3d half{0.5 * x, 0.5 * y, 0.5 * z};
  builder.add(args, ElementKind::box, Segment{-half, half}, material);
}

void cone(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const SourceLocation where = args.here();
  const double base_radius = args.not_negative("the radius of the base");
  const Vec3d base = args.triple("the base, x y z");
  const double apex_radius = args.not_negative("the radius of the apex");
  const SourceLocation where_apex = args.here();
  const Vec3d apex = args.triple("the apex, x y z");
  const double largest = std::max(base_radius, apex_radius);
  if (!args.failed() && !(largest > 0)) {
    args.fail(where, "both radii are 0, expected one > 0");
  } else if (!args.failed() && !(norm(apex - base) > 1e-12 * largest)) {
    args.fail(where_apex, "a cone without height, expected an apex apart from the base");
  }
  Element* element =
      builder.add(args, ElementKind::cone, Segment{base, apex}, material, base_radius);
  if (element != nullptr) element->apex_radius = apex_radius;
}

void sphere(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const double radius = args.positive("the radius");
  const Vec3d center = args.triple("the center, x y z");
  builder.add(args, ElementKind::sphere, Point{center}, material, radius);
}

void cylinder(SceneBuilder& builder, Arguments& args) {
  rod(builder, args, Spelling::plain);
}

void pipe(SceneBuilder& builder, Arguments& args) {
  rod(builder, args, Spelling::pipe);
}

void dot(SceneBuilder& builder, Arguments& args) {
  point(builder, args, ElementKind::dot);
}

void gauss(SceneBuilder& builder, Arguments& args) {
  point(builder, args, ElementKind::gauss);
}

void line(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const Segment segment = read_segment(args);
  const std::optional<SegmentWeight> taper = read_taper(args);
  builder.add(args, ElementKind::line, segment, material, std::nullopt, Spelling::plain, taper);
}

void triangle(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  Triangle triangle;
  for (Vec3d& vertex : triangle.vertex) vertex = args.triple("a vertex, x y z");
  builder.add(args, ElementKind::triangle, triangle, material);
}

void polygon(SceneBuilder& builder, Arguments& args) {
  constexpr std::size_t kMostVertices = 128;
  const int material = builder.read_material(args);
  std::vector<Vec3d> vertices;
  std::vector<SourceLocation> places;
  while (args.more() || (!args.failed() && vertices.size() < 3)) {
    places.push_back(args.here());
    vertices.push_back(args.triple("a vertex, x y z"));
    if (vertices.size() > kMostVertices) {
      args.fail(places.back(),
                "too many vertices, expected at most " + std::to_string(kMostVertices));
    }
  }
  if (args.failed()) return;
  auto made = make_polygon(std::move(vertices));
  if (const auto* fault = std::get_if<PolygonFault>(&made)) {
    args.fail(places[fault->vertex], std::string(fault->what) +
                                         ", expected a flat polygon whose edges meet at their"
                                         " common ends alone");
    return;
  }
  builder.add_polygon(args, std::get<Polygon>(std::move(made)), material);
}

void quadric(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const SourceLocation where = args.here();
  const Vec3d squares = read_coefficients(args, "xx, yy and zz");
  const Vec3d products = 0.5 * read_coefficients(args, "xy, xz and yz");
  Quadric quadric;
  quadric.square = {squares.x, squares.y, squares.z, products.x, products.y, products.z};
  quadric.linear = read_coefficients(args, "x, y and z");
  quadric.constant = args.number("the constant");
  if (args.take_if("bounds", 3)) quadric.bounds = read_box(args);
  if (!args.failed() && quadric.square == Symmetric3{} && quadric.linear == Vec3d{}) {
    args.fail(where, "all coefficients are 0, expected one of x, y or z, or of a product of them");
  }
  builder.add_quadric(args, quadric, material);
}

void plane(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const Vec3d position = args.triple("a point of the plane, x y z");
  const Vec3d normal = args.direction("the normal, x y z");
  builder.add(args, ElementKind::plane, Plane{position, normal}, material);
}

void arc(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const double sweep_radius = args.positive("the sweep radius");
  const double tube_radius = args.positive("the tube radius");
  const Vec3d center = args.triple("the center, x y z");
  const Vec3d normal = args.direction("the normal, x y z");
  const double start = args.number("the start angle in degrees");
  const SourceLocation where = args.here();
  const std::string_view word = args.peek();
  const double width = args.number("the width in degrees");
  if (!args.failed() && !(width > 0 && width <= 360)) {
    args.fail(where, in_quotes(word) +
                         " is out of range, expected the width in degrees, > 0 and"
                         " <= 360");
  }
  if (args.failed()) return;
  builder.add(args, ElementKind::arc, make_arc(center, sweep_radius, normal, start, width),
              material, tube_radius);
}

void torus(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const double sweep_radius = args.positive("the sweep radius");
  const double tube_radius = args.positive("the tube radius");
  const Vec3d center = args.triple("the center, x y z");
  const Vec3d normal = args.direction("the normal, x y z");
  builder.add(args, ElementKind::arc, make_arc(center, sweep_radius, normal, 0, 360), material,
              tube_radius, Spelling::torus);
}

void arch(SceneBuilder& builder, Arguments& args) {
  const int material = builder.read_material(args);
  const double radius = args.positive("the tube radius");
  const SourceLocation where = args.here();
  const Vec3d p1 = args.triple("the first point, x y z");
  const Vec3d p2 = args.triple("the second point, x y z");
  const Vec3d p3 = args.triple("the third point, x y z");
  if (args.failed()) return;
  const auto curve = make_arch(p1, p2, p3);
  if (!curve) {
    args.fail(where,
              "no circular arc runs through these points, expected the second between the others");
    return;
  }
  const Primitive skeleton = std::visit([](const auto& c) -> Primitive { return c; }, *curve);
  builder.add(args, ElementKind::arch, skeleton, material, radius);
}

}  // namespace cs2mesh::commands
