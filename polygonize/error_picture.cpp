#include "polygonize/error_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "libfield/base/color.h"
#include "polygonize/closest_point.h"
#include "polygonize/surface_projection.h"

namespace cs2mesh {
namespace {

constexpr int kTile = 16;  // pixels; near each other, so that the field can be restricted

/// The colours of viridis (Smith and van der Walt 2015, released to the public domain) at tenths.
constexpr std::array<std::array<int, 3>, 10> kViridis = {{{68, 1, 84},
                                                          {72, 40, 120},
                                                          {62, 73, 137},
                                                          {49, 104, 142},
                                                          {38, 130, 142},
                                                          {31, 158, 137},
                                                          {53, 183, 121},
                                                          {110, 206, 88},
                                                          {181, 222, 43},
                                                          {253, 231, 37}}};
constexpr std::array<int, 3> kNothing = {232, 232, 232};
constexpr std::array<int, 3> kMissing = {255, 0, 200};

/// An sRGB colour 0..255 in linear light.
Vec3<float> linear(const Vec3d& coded) {
  return Vec3<float>(Vec3d{srgb_to_linear(coded.x / 255), srgb_to_linear(coded.y / 255),
                           srgb_to_linear(coded.z / 255)});
}

Vec3d as_vector(const std::array<int, 3>& color) {
  return {static_cast<double>(color[0]), static_cast<double>(color[1]),
          static_cast<double>(color[2])};
}

/// `share` 0..1 of the way from the first colour to the last.
Vec3<float> scale_color(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double t = place - static_cast<double>(i);
  return linear((1 - t) * as_vector(kViridis[i]) + t * as_vector(kViridis[i + 1]));
}

/// What the rays of one tile meet of one part.
struct Met {
  std::vector<Vec3d> points;
  std::vector<std::array<int, 2>> pixels;
};

class ErrorPicture {
 public:
  ErrorPicture(const Model& model, const CompiledScene& compiled, const View& view, int width,
               int height)
      : compiled_(compiled),
        view_(view),
        search_limit_(2 * compiled.extent.diagonal()),
        image_(width, height, std::numeric_limits<float>::quiet_NaN()) {
    for (const MeshPart& part : model.parts) trees_.emplace_back(part.mesh);
  }

  void draw_tile(int left, int top) {
    std::vector<Met> met(trees_.size());
    for (int y = top; y < std::min(top + kTile, image_.height()); ++y) {
      for (int x = left; x < std::min(left + kTile, image_.width()); ++x) look(x, y, met);
    }
    for (std::size_t part = 0; part < met.size(); ++part) {
      if (met[part].points.empty()) continue;
      std::vector<Projection> nearest(met[part].points.size());
      project(*compiled_.parts[part].surface, met[part].points, search_limit_, nearest);
      for (std::size_t i = 0; i < nearest.size(); ++i) {
        const auto& [x, y] = met[part].pixels[i];
        image_.at(x, y) = static_cast<float>(nearest[i].distance);
      }
    }
  }

  ScalarImage take() { return std::move(image_); }

 private:
  void look(int x, int y, std::vector<Met>& met) const {
    const Ray ray = view_.ray((x + 0.5) / image_.width(), (y + 0.5) / image_.height());
    double t = std::numeric_limits<double>::infinity();
    std::size_t nearest = trees_.size();
    for (std::size_t part = 0; part < trees_.size(); ++part) {
      const double at = trees_[part].first_hit(ray.origin, ray.direction, 0, t);
      if (!(at < t)) continue;
      t = at;
      nearest = part;
    }
    if (nearest == trees_.size()) return;
    met[nearest].points.push_back(ray.at(t));
    met[nearest].pixels.push_back({x, y});
  }

  const CompiledScene& compiled_;
  View view_;
  double search_limit_;
  std::vector<ClosestPoint> trees_;
  ScalarImage image_;
};

}  // namespace

ScalarImage error_picture(const Model& model, const CompiledScene& compiled, const View& view,
                          int width, int height, Progress* progress) {
  require(model.parts.size() == compiled.parts.size(), "error_picture: a mesh a part");
  ErrorPicture picture(model, compiled, view, width, height);
  const int columns = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  tbb::parallel_for(0, columns * rows, [&](int tile) {
    if (!cancelled(progress)) picture.draw_tile(tile % columns * kTile, tile / columns * kTile);
  });
  return picture.take();
}

void mark_missing_mesh(const ScalarImage& depth, ScalarImage& errors) {
  require(depth.width() == errors.width() && depth.height() == errors.height(),
          "mark_missing_mesh: pictures of one size");
  for (std::size_t i = 0; i < errors.pixels().size(); ++i) {
    if (std::isfinite(depth.pixels()[i]) && std::isnan(errors.pixels()[i])) {
      errors.pixels()[i] = std::numeric_limits<float>::infinity();
    }
  }
}

ColorImage false_colors(const ScalarImage& errors, double low, double high) {
  require(0 < low && low < high, "false_colors: 0 < low < high");
  ColorImage image(errors.width(), errors.height(), linear(as_vector(kNothing)));
  for (std::size_t i = 0; i < errors.pixels().size(); ++i) {
    const double error = errors.pixels()[i];
    if (std::isnan(error)) continue;
    image.pixels()[i] = std::isinf(error) ? linear(as_vector(kMissing))
                        : error > 0 ? scale_color(std::log(error / low) / std::log(high / low))
                                    : scale_color(0);
  }
  return image;
}

ColorImage false_color_scale(int width) {
  ColorImage image(width, 1);
  for (int x = 0; x < width; ++x) image.at(x, 0) = scale_color((x + 0.5) / width);
  return image;
}

}  // namespace cs2mesh
