// PNG files (through libpng).
#pragma once

#include <string>

#include "libfield/base/result.h"
#include "libfield/ray/image.h"

namespace cs2mesh {

/// The bytes of an 8-bit sRGB-coded PNG of linear RGB; channels are clamped to 0..1 and rounded to
/// the nearest code, NaN is black. The image has pixels (ContractViolation). Error:
/// Failure::output, without a place.
Result<std::string> encode_png(const ColorImage& image);

/// Writes those to a file, which appears whole or not at all. Error: Failure::output.
Result<Done> write_png(const std::string& path, const ColorImage& image);

/// Reads a PNG of any kind as linear RGB; transparent pixels are laid over black. Errors
/// (Failure::bad_input): the file cannot be read, is no PNG, is damaged or has more than
/// kMostPixels.
Result<ColorImage> read_png(const std::string& path);

}  // namespace cs2mesh
