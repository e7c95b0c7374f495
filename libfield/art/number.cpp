#include "libfield/art/number.h"

#include <charconv>
#include <cmath>

namespace cs2mesh {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Whether a well-formed decimal number that no double is near to is too large rather than too
/// small: the sign of the exponent of its first digit that is not 0.
bool is_large(std::string_view text) {
  long exponent = 0;
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    const char* begin = text.data() + e + 1;
    const char* end = text.data() + text.size();
    const bool negative = *begin == '-';
    if (*begin == '+' || *begin == '-') ++begin;
    constexpr long kHuge = 1'000'000'000'000L;  // longer than any file has digits
    if (std::from_chars(begin, end, exponent).ec != std::errc{} || exponent > kHuge) {
      exponent = kHuge;
    }
    if (negative) exponent = -exponent;
    text = text.substr(0, e);
  }
  long place = 0;  // power of ten of the digit before the point, counted from the first digit
  long first = 0;
  bool seen = false;
  bool after_point = false;
  for (const char c : text) {
    if (c == '.') after_point = true;
    if (!is_digit(c)) continue;
    if (c != '0' && !seen) {
      seen = true;
      first = after_point ? place - 1 : 0;
      if (after_point) break;
      continue;
    }
    if (after_point) {
      if (seen) break;
      --place;
    } else if (seen) {
      ++first;
    }
  }
  return first + exponent > 0;
}

}  // namespace

ParsedNumber parse_number(std::string_view text) {
  const std::string_view digits = text.substr(!text.empty() && text.front() == '-' ? 1 : 0);
  if (digits.empty() || !(is_digit(digits.front()) || digits.front() == '.')) return {};
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (rest != end || error == std::errc::invalid_argument) return {};
  if (error == std::errc::result_out_of_range) {
    if (is_large(text)) return {NumberStatus::overflow, 0.0};
    return {NumberStatus::ok, text.front() == '-' ? -0.0 : 0.0};
  }
  if (!std::isfinite(value)) return {NumberStatus::overflow, 0.0};
  return {NumberStatus::ok, value};
}

}  // namespace cs2mesh
