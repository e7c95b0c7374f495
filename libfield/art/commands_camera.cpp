// The camera: where it is, where it looks, how large its picture is.
#include "libfield/art/commands.h"

namespace cs2mesh::commands {
namespace {

constexpr int kMaxPixels = 65536;  // a side of the picture
constexpr int kMaxSamples = 16;    // a side of the grid of rays in a pixel

double angle(Arguments& args, std::string_view what) {
  const SourceLocation where = args.here();
  const std::string_view word = args.peek();
  const double degrees = args.number(what);
  if (!args.failed() && !(degrees > 0 && degrees < 180)) {
    args.fail(where, in_quotes(word) + " is out of range, expected " + std::string(what) +
                         " in degrees, > 0 and < 180");
  }
  return degrees;
}

}  // namespace

void vrp(SceneBuilder& builder, Arguments& args) {
  const Vec3d point = args.triple("the point looked at, x y z");
  if (args.finish()) builder.scene().camera.look_at = point;
}

void vup(SceneBuilder& builder, Arguments& args) {
  const Vec3d up = args.direction("the direction up, x y z");
  if (args.finish()) builder.scene().camera.up = up;
}

void eyep(SceneBuilder& builder, Arguments& args) {
  const Vec3d eye = args.triple("the eye's position, x y z");
  if (!args.finish()) return;
  builder.scene().camera.eye = eye;
  builder.scene().camera.has_eye = true;
}

void fov(SceneBuilder& builder, Arguments& args) {
  const double horizontal = angle(args, "the horizontal field of view");
  const double vertical = angle(args, "the vertical field of view");
  if (!args.finish()) return;
  builder.scene().camera.fov_horizontal = horizontal;
  builder.scene().camera.fov_vertical = vertical;
}

void framesize(SceneBuilder& builder, Arguments& args) {
  const int width = args.integer("the width in pixels", 1, kMaxPixels);
  const int height = args.integer("the height in pixels", 1, kMaxPixels);
  if (!args.finish()) return;
  builder.scene().camera.width = width;
  builder.scene().camera.height = height;
}

void sample(SceneBuilder& builder, Arguments& args) {
  const int samples = args.integer("the samples along a side of a pixel", 1, kMaxSamples);
  if (args.more()) {
    builder.log().once(Severity::note, "sample options", args.here(),
                       "the options of 'sample' do nothing here");
    while (args.more()) args.skip();
  }
  if (args.finish()) builder.scene().camera.samples = samples;
}

}  // namespace cs2mesh::commands
