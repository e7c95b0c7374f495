// Numbers as people are told them.
#pragma once

#include <cstdio>
#include <string>

namespace cs2mesh {

/// The number as printf's `format` has it: one conversion of a double, no more than 63 characters.
inline std::string printed(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

}  // namespace cs2mesh
