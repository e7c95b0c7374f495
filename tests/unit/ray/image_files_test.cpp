#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "libfield/base/color.h"
#include "libfield/base/random.h"
#include "libfield/ray/pfm.h"
#include "libfield/ray/png.h"

namespace cs2mesh {
namespace {

class ImageFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("cs2mesh_image_files_" + std::string(test->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::string bytes(const char* name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void put(const char* name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
  }

 private:
  std::filesystem::path folder_;
};

ColorImage noise(int width, int height) {
  ColorImage image(width, height);
  Random random(7);
  for (Vec3<float>& pixel : image.pixels()) {
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(random.uniform());
  }
  return image;
}

TEST_F(ImageFiles, PngKeepsEveryCodeAndRoundsOthersToTheNearest) {
  ColorImage image(256, 2);
  for (int x = 0; x < 256; ++x) {
    const auto linear = static_cast<float>(srgb_to_linear(x / 255.0));
    image.at(x, 0) = {linear, 0.0F, static_cast<float>(srgb_to_linear((x + 0.4) / 255.0))};
    image.at(x, 1) = {-1.0F, 2.0F, std::numeric_limits<float>::quiet_NaN()};
  }
  ASSERT_TRUE(write_png(path("a.png"), image));
  const Result<ColorImage> back = read_png(path("a.png"));
  ASSERT_TRUE(back);
  ASSERT_EQ(back->width(), 256);
  ASSERT_EQ(back->height(), 2);
  for (int x = 0; x < 256; ++x) {
    EXPECT_EQ(back->at(x, 0), (Vec3<float>{image.at(x, 0).x, 0.0F, image.at(x, 0).x}));
    EXPECT_EQ(back->at(x, 1), (Vec3<float>{0.0F, 1.0F, 0.0F}));
  }
}

TEST_F(ImageFiles, PngRefusesDamageWithAMessage) {
  EXPECT_FALSE(read_png(path("missing.png")));
  put("text.png", "no picture at all");
  const Result<ColorImage> text = read_png(path("text.png"));
  ASSERT_FALSE(text);
  EXPECT_EQ(text.diagnostics()[0].failure, Failure::bad_input);
  ASSERT_TRUE(write_png(path("whole.png"), noise(40, 30)));
  const std::string whole = bytes("whole.png");
  for (const std::size_t size : {std::size_t{8}, std::size_t{30}, whole.size() / 2}) {
    put("cut.png", whole.substr(0, size));
    EXPECT_FALSE(read_png(path("cut.png"))) << size;
  }
}

TEST_F(ImageFiles, OutputFailuresAreReported) {
  const Result<Done> result = write_png(path("no/such/folder/a.png"), noise(2, 2));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.diagnostics()[0].failure, Failure::output);
  EXPECT_FALSE(write_pfm(path("no/such/folder/a.pfm"), noise(2, 2)));
}

TEST_F(ImageFiles, PfmHasItsBytesWhereTheFormatSays) {
  ScalarImage image(2, 2);
  image.at(0, 0) = 1.0F;
  image.at(1, 0) = std::numeric_limits<float>::infinity();
  image.at(0, 1) = -2.0F;
  ASSERT_TRUE(write_pfm(path("a.pfm"), image));
  // Bottom row first, little-endian.
  const char raw[] = "Pf\n2 2\n-1.0\n\0\0\0\xC0\0\0\0\0\0\0\x80\x3F\0\0\x80\x7F";
  EXPECT_EQ(bytes("a.pfm"), std::string(raw, sizeof raw - 1));
}

TEST_F(ImageFiles, PfmRoundTripIsExact) {
  ColorImage image = noise(5, 7);
  image.at(2, 3).y = -std::numeric_limits<float>::infinity();
  ASSERT_TRUE(write_pfm(path("a.pfm"), image));
  const Result<ColorImage> back = read_pfm(path("a.pfm"));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->width(), 5);
  EXPECT_EQ(back->pixels(), image.pixels());
}

TEST_F(ImageFiles, PfmRefusesImpossibleHeads) {
  for (const char* head :
       {"", "P6\n2 2\n-1.0\n", "Pf\n2 2\n0\n", "Pf\n0 2\n-1.0\n", "Pf\n2 2\n-1.0\nabc",
        "Pf\n1000000000 1000000000\n-1.0\n", "Pf\n9223372036854775807 2\n-1.0\n"}) {
    put("bad.pfm", head);
    EXPECT_FALSE(read_pfm(path("bad.pfm"))) << head;
  }
  EXPECT_FALSE(read_pfm(path("missing.pfm")));
}

}  // namespace
}  // namespace cs2mesh
