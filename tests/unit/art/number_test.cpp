#include "libfield/art/number.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

TEST(Number, reads_decimal_forms) {
  const std::pair<const char*, double> kCases[] = {
      {"0", 0},      {"-1", -1},        {".5", 0.5},     {"-.5", -0.5},
      {"5.", 5},     {"1e3", 1000},     {"1E-3", 0.001}, {"1.5e+2", 150},
      {"007", 7},    {"0.1", 0.1},      {"-0", -0.0},    {"4.9e-324", 5e-324},
      {"1e-999", 0}, {"-1e-999", -0.0}, {"0e999", 0},    {"0.0001e-99999999999999999999", 0}};
  for (const auto& [text, value] : kCases) {
    const ParsedNumber parsed = parse_number(text);
    EXPECT_EQ(parsed.status, NumberStatus::ok) << text;
    EXPECT_EQ(parsed.value, value) << text;
    EXPECT_EQ(std::signbit(parsed.value), std::signbit(value)) << text;
  }
}

TEST(Number, refuses_other_words) {
  for (const char* text :
       {"",         "-",    ".",      "-.",  "+1",    "nan",   "-nan", "inf", "-inf",
        "infinity", "0x10", "-0x1p3", "1e",  "1e+",   "1.2.3", "1,5",  "1f",  "1 ",
        " 1",       "--1",  "one",    "50%", "1_000", "e5",    "-e5"}) {
    EXPECT_EQ(parse_number(text).status, NumberStatus::not_a_number) << text;
  }
}

TEST(Number, tells_overflow_from_underflow) {
  for (const std::string& text :
       {std::string("1e309"), std::string("-1e309"), std::string("1e99999999999999999999"),
        "1" + std::string(400, '0'), "0." + std::string(100, '0') + "1e500",
        std::string("2e308")}) {
    EXPECT_EQ(parse_number(text).status, NumberStatus::overflow) << text;
  }
  for (const std::string& text :
       {"0." + std::string(400, '0') + "1", std::string("1e-400"),
        "1" + std::string(10, '0') + "e-500", std::string("1e-99999999999999999999")}) {
    EXPECT_EQ(parse_number(text).status, NumberStatus::ok) << text;
    EXPECT_EQ(parse_number(text).value, 0.0) << text;
  }
}

TEST(Number, returns_what_was_printed) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double x =
        std::ldexp(random.uniform(-1, 1), static_cast<int>(random.uniform(-1070, 1020)));
    char text[40];
    *std::to_chars(text, text + sizeof text - 1, x).ptr = '\0';
    EXPECT_EQ(parse_number(text).value, x);
  }
}

}  // namespace
}  // namespace cs2mesh
