// Decimal numbers as the scene language writes them.
#pragma once

#include <string_view>

namespace cs2mesh {

enum class NumberStatus {
  ok,
  not_a_number,  ///< some other word; also nan, inf, hexadecimal, a leading +
  overflow,      ///< a decimal number beyond the largest double
};

struct ParsedNumber {
  NumberStatus status = NumberStatus::not_a_number;
  double value = 0.0;
};

/// Reads the whole of `text` as [-]digits[.digits][e[sign]digits], correctly rounded, with digits
/// on at least one side of the point. Numbers too small for a double become 0 of their sign.
ParsedNumber parse_number(std::string_view text);

}  // namespace cs2mesh
