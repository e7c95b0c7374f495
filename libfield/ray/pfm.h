// Raw float images in the portable float map format: depth, normals, costs.
#pragma once

#include <string>

#include "libfield/base/result.h"
#include "libfield/ray/image.h"

namespace cs2mesh {

/// Writes a portable float map: the line "Pf" (one channel) or "PF" (three), the line "width
/// height", the line "-1.0" (little-endian), then 32-bit IEEE floats, rows from the bottom, each
/// from the left. No value is changed; infinities and NaN stay what they are. The file appears
/// whole or not at all. Error: Failure::output.
Result<Done> write_pfm(const std::string& path, const ScalarImage& image);
Result<Done> write_pfm(const std::string& path, const ColorImage& image);

/// Reads a portable float map, either byte order; one channel is returned as three equal ones. The
/// scale factor is not applied. Errors (Failure::bad_input): the file cannot be read, its head is
/// malformed, it is too short or has more than kMostPixels.
Result<ColorImage> read_pfm(const std::string& path);

}  // namespace cs2mesh
