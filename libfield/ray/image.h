// Rectangles of pixels.
#pragma once

#include <cstddef>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

/// Pixels in rows from the top, each from the left.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, const T& fill = {})
      : width_(width), height_(height), pixels_(count(width, height), fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  T& at(int x, int y) { return pixels_[index(x, y)]; }
  const T& at(int x, int y) const { return pixels_[index(x, y)]; }
  std::vector<T>& pixels() { return pixels_; }
  const std::vector<T>& pixels() const { return pixels_; }

 private:
  static std::size_t count(int width, int height) {
    require(width >= 0 && height >= 0, "an image has no negative size");
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  int width_ = 0;
  int height_ = 0;
  std::vector<T> pixels_;
};

/// Linear RGB, or the components of a vector.
using ColorImage = Image<Vec3<float>>;
using ScalarImage = Image<float>;

/// No image that is read or rendered has more pixels than this.
inline constexpr long long kMostPixels = 1LL << 26;

}  // namespace cs2mesh
