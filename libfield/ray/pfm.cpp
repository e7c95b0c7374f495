#include "libfield/ray/pfm.h"

#include <bit>
#include <cstdint>
#include <fstream>

#include "libfield/base/atomic_file.h"

namespace cs2mesh {
namespace {

void append(std::string& bytes, float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(bits >> shift));
}
void append(std::string& bytes, const Vec3<float>& v) {
  append(bytes, v.x);
  append(bytes, v.y);
  append(bytes, v.z);
}

template <class T>
Result<Done> write(const std::string& path, const Image<T>& image, const char* magic) {
  std::string bytes = std::string(magic) + "\n" + std::to_string(image.width()) + " " +
                      std::to_string(image.height()) + "\n-1.0\n";
  bytes.reserve(bytes.size() + sizeof(T) * image.pixels().size());
  for (int y = image.height() - 1; y >= 0; --y) {
    for (int x = 0; x < image.width(); ++x) append(bytes, image.at(x, y));
  }
  return write_file(path, bytes);
}

float decode(const char* bytes, bool little) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) {
    const auto byte = static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]));
    bits |= byte << (little ? 8 * i : 24 - 8 * i);
  }
  return std::bit_cast<float>(bits);
}

}  // namespace

Result<Done> write_pfm(const std::string& path, const ScalarImage& image) {
  return write(path, image, "Pf");
}

Result<Done> write_pfm(const std::string& path, const ColorImage& image) {
  return write(path, image, "PF");
}

Result<ColorImage> read_pfm(const std::string& path) {
  const auto bad = [&](const char* why) {
    return error_at({path, 0, 0}, std::string("cannot read this PFM: ") + why);
  };
  std::ifstream file(path, std::ios::binary);
  if (!file) return bad("the file cannot be opened");
  std::string magic;
  long long width = 0;
  long long height = 0;
  double scale = 0.0;
  file >> magic >> width >> height >> scale;
  if (!file || (magic != "Pf" && magic != "PF") || scale == 0.0)
    return bad("its head is malformed");
  if (width < 1 || height < 1 || width > kMostPixels || height > kMostPixels / width) {
    return bad("its size is impossible");
  }
  file.get();  // the one white space before the floats
  const std::size_t channels = magic == "PF" ? 3 : 1;
  const std::size_t row = 4 * channels * static_cast<std::size_t>(width);
  ColorImage image(static_cast<int>(width), static_cast<int>(height));
  std::string bytes(row, '\0');
  for (int y = image.height() - 1; y >= 0; --y) {
    if (!file.read(bytes.data(), static_cast<std::streamsize>(row))) {
      return bad("it ends too early");
    }
    const char* next = bytes.data();
    for (int x = 0; x < image.width(); ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        image.at(x, y)[c] = decode(next + (channels == 3 ? 4 * c : 0), scale < 0.0);
      }
      next += 4 * channels;
    }
  }
  return image;
}

}  // namespace cs2mesh
