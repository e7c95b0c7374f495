#include "libfield/art/colors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace cs2mesh {
namespace {

TEST(Colors, x11_names) {
  EXPECT_EQ(color_of("OrangeRed"), (Color{1, 69 / 255.0, 0}));
  EXPECT_EQ(color_of("DarkRed"), (Color{139 / 255.0, 0, 0}));
  EXPECT_EQ(color_of("Gold"), (Color{1, 215 / 255.0, 0}));
  EXPECT_EQ(color_of("Gray15"), (Color{38 / 255.0, 38 / 255.0, 38 / 255.0}));
  EXPECT_EQ(color_of("Grey100"), (Color{1, 1, 1}));
  EXPECT_EQ(color_of("Gray0"), (Color{0, 0, 0}));
}

TEST(Colors, povray_names) {
  EXPECT_EQ(color_of("SummerSky"), (Color{0.22, 0.69, 0.87}));
  EXPECT_EQ(color_of("LightWood"), (Color{0.91, 0.76, 0.65}));
  EXPECT_EQ(color_of("MediumWood"), (Color{0.65, 0.5, 0.39}));
  EXPECT_EQ(color_of("DarkWood"), (Color{0.52, 0.37, 0.26}));
}

TEST(Colors, first_letters_of_words_may_be_small) {
  for (const char* name : {"LightBlue", "lightBlue", "Lightblue", "lightblue"}) {
    EXPECT_EQ(color_of(name), color_of("LightBlue")) << name;
    EXPECT_TRUE(color_of(name)) << name;
  }
  EXPECT_TRUE(color_of("gray15"));
  for (const char* name : {"LIGHTBLUE", "lIghtBlue", "White ", "", "Gray101", "light blue"}) {
    EXPECT_FALSE(color_of(name)) << name;
  }
}

TEST(Colors, every_name_is_found_and_in_range) {
  EXPECT_GT(color_names().size(), 600u);
  for (const std::string_view name : color_names()) {
    const auto color = color_of(name);
    ASSERT_TRUE(color) << name;
    for (const double channel : {color->r, color->g, color->b}) {
      EXPECT_GE(channel, 0);
      EXPECT_LE(channel, 1);
    }
    std::string small(name);
    std::transform(small.begin(), small.end(), small.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    EXPECT_EQ(color_of(small), color) << name;
  }
}

}  // namespace
}  // namespace cs2mesh
