// Replays the fuzzer's corpus and what it once found.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/fuzz/art_fuzz_case.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

TEST(Corpus, every_input_holds) {
  const fs::path root = CS2MESH_SOURCE_DIR;
  int count = 0;
  for (const char* folder : {"data/corpus/art", "data/bad", "data/scenes"}) {
    for (const auto& entry : fs::directory_iterator(root / folder)) {
      std::ifstream stream(entry.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      EXPECT_TRUE(fuzz_case_holds(text)) << entry.path();
      ++count;
    }
  }
  EXPECT_GT(count, 80);
}

}  // namespace
}  // namespace cs2mesh
