// Objects: their nesting, their transforms, their blend groups.
#include "libfield/art/commands.h"

namespace cs2mesh::commands {

void object(SceneBuilder& builder, Arguments& args) {
  const std::string_view name = args.word("the name of an object");
  if (args.failed()) return;
  args.finish();
  builder.open_object(args, name);
}

void chain(SceneBuilder& builder, Arguments& args) {
  const int material = builder.material_named(args);
  // Opened even when it is wrong, so that its primitives and its 'close' are not reported too.
  const std::string_view name = args.failed() ? "" : args.word("the name of a chain");
  args.finish();
  builder.open_object(args, name, material);
}

void instance(SceneBuilder& builder, Arguments& args) {
  const int original = builder.object_named(args);
  const std::string_view name = args.word("the name of the clone");
  if (args.finish()) builder.clone(args, original, std::string(name));
}

void close(SceneBuilder& builder, Arguments& args) {
  const Object* const object = builder.innermost();
  if (!object) {
    args.fail(args.opcode_location(),
              "'close' without an open object, expected 'object' or 'chain'"
              " before it");
    return;
  }
  if (args.more() && args.peek() != object->name) {
    builder.log().once(
        Severity::warning, "close", args.here(),
        "'close' names " + in_quotes(args.peek()) + " but closes " + in_quotes(object->name));
  }
  if (args.more()) args.skip();
  args.finish();
  builder.close_object();
}

void translate(SceneBuilder& builder, Arguments& args) {
  const Vec3d shift = args.triple("the translation, x y z");
  builder.apply(args, Affine::translate(shift));
}

void rotate(SceneBuilder& builder, Arguments& args) {
  const Vec3d axis = args.direction("the axis, x y z");
  const double degrees = args.number("the angle in degrees");
  builder.apply(args, Affine::rotate(axis, degrees));
}

void scale(SceneBuilder& builder, Arguments& args) {
  const SourceLocation where = args.here();
  const Vec3d factors = args.triple("the factors, x y z");
  if (!args.failed() && (factors.x == 0 || factors.y == 0 || factors.z == 0)) {
    args.fail(where, "a factor is zero, expected factors other than zero");
  }
  builder.apply(args, Affine::scale(factors));
}

void blend(SceneBuilder& builder, Arguments& args) {
  Object* const object = builder.innermost();
  if (!object) {
    args.fail(args.opcode_location(), "'blend' outside of an object, expected 'object' before it");
    return;
  }
  const std::string_view group = args.more() ? args.word("the name of a blend group") : "";
  if (args.finish()) object->blend = std::string(group);
}

void remove(SceneBuilder& builder, Arguments& args) {
  if (args.left() > 1 && args.peek() == "object") args.skip();
  const int object = builder.object_named(args);
  if (args.finish()) builder.remove(args, object);
}

}  // namespace cs2mesh::commands
