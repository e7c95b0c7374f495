#include "libfield/ray/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libfield/base/atomic_file.h"
#include "libfield/base/color.h"

namespace cs2mesh {
namespace {

std::uint8_t coded(float linear) {
  if (!(linear > 0.0F)) return 0;
  const double code = 255.0 * linear_to_srgb(std::min(1.0, static_cast<double>(linear)));
  return static_cast<std::uint8_t>(std::lround(code));
}

/// libpng's own view of an image, freed in every case.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(&image); }
};

Diagnostic bad_png(const std::string& path, const std::string& why) {
  return error_at({path, 0, 0}, "cannot read this PNG: " + why);
}

}  // namespace

Result<std::string> encode_png(const ColorImage& image) {
  require(!image.empty(), "an image to be written has pixels");
  std::vector<std::uint8_t> codes;
  codes.reserve(3 * image.pixels().size());
  for (const Vec3<float>& pixel : image.pixels()) {
    codes.insert(codes.end(), {coded(pixel.x), coded(pixel.y), coded(pixel.z)});
  }
  PngImage png;
  png.image.width = static_cast<png_uint_32>(image.width());
  png.image.height = static_cast<png_uint_32>(image.height());
  png.image.format = PNG_FORMAT_RGB;
  const auto encode = [&](void* memory, png_alloc_size_t& size) {
    return png_image_write_to_memory(&png.image, memory, &size, 0, codes.data(), 0, nullptr) != 0;
  };
  png_alloc_size_t size = 0;
  std::string bytes;
  bool done = encode(nullptr, size);
  if (done) {
    bytes.resize(size);
    done = encode(bytes.data(), size);
  }
  if (!done) {
    return error_at({}, std::string("cannot encode as PNG: ") + png.image.message, Failure::output);
  }
  return bytes;
}

Result<Done> write_png(const std::string& path, const ColorImage& image) {
  const Result<std::string> bytes = encode_png(image);
  if (!bytes) {
    Diagnostic error = bytes.diagnostics().front();
    error.where = {path, 0, 0};
    return error;
  }
  return write_file(path, *bytes);
}

Result<ColorImage> read_png(const std::string& path) {
  PngImage png;
  if (!png_image_begin_read_from_file(&png.image, path.c_str())) {
    return bad_png(path, png.image.message);
  }
  const long long count = static_cast<long long>(png.image.width) * png.image.height;
  if (count > kMostPixels) return bad_png(path, "it has too many pixels");
  png.image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> codes(PNG_IMAGE_SIZE(png.image));
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&png.image, &black, codes.data(), 0, nullptr)) {
    return bad_png(path, png.image.message);
  }
  std::array<float, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i) {
    linear[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255.0));
  }
  ColorImage image(static_cast<int>(png.image.width), static_cast<int>(png.image.height));
  for (std::size_t i = 0; i < image.pixels().size(); ++i) {
    image.pixels()[i] = {linear[codes[3 * i]], linear[codes[3 * i + 1]], linear[codes[3 * i + 2]]};
  }
  return image;
}

}  // namespace cs2mesh
