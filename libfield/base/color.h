// The sRGB transfer function (IEC 61966-2-1): colours of scenes and of OBJ, PLY, PNG are coded with
// it; light is mixed, and glTF vertex colours are stored, in linear RGB.
#pragma once

#include <cmath>

namespace cs2mesh {

/// A coded channel 0..1 as linear light 0..1; other values follow the same curve, negatives the
/// straight part.
inline double srgb_to_linear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

/// The inverse of srgb_to_linear (to 1e-7: the two pieces of the standard do not quite meet).
inline double linear_to_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace cs2mesh
