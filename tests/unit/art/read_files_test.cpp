// Files that read files, and the limits on what is read.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "art_testing.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

class ReadFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("cs2mesh_art_" + std::string(info->name()));
    fs::create_directories(folder_ / "sub");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return path(name);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  fs::path folder_;
};

TEST_F(ReadFiles, paths_are_relative_to_the_reading_file) {
  write("sub/a.dat", "read b.dat ../c.dat\nsphere S 3 0 0 0\n");
  write("sub/b.dat", "sphere S 1 0 0 0\nreturn\nsphere S 9 0 0 0\n");
  write("c.dat", "sphere S 2 0 0 0\n");
  const std::string main =
      write("main.art", "surface S radius 1\nread sub/a.dat\nsphere S 4 0 0 0\n");
  const Result<Scene> scene = read_art(main);
  ASSERT_TRUE(scene) << lines_of(scene);
  EXPECT_EQ(scene->file, main);
  ASSERT_EQ(scene->elements.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(scene->elements[static_cast<std::size_t>(i)].own_radius, i + 1);
  }
  EXPECT_EQ(scene->elements[0].where.file, path("sub/b.dat"));
}

TEST_F(ReadFiles, text_in_memory_reads_beside_its_name) {
  write("a.dat", "surface S radius 1\n");
  const Result<Scene> scene = parse_art("read a.dat\nsphere S 1 0 0 0", path("main.art"));
  EXPECT_TRUE(scene) << lines_of(scene);
}

TEST_F(ReadFiles, quit_ends_all_files) {
  write("a.dat", "quit\n");
  EXPECT_TRUE(read_art(write("main.art", "read a.dat\nnonsense\n")));
}

TEST_F(ReadFiles, reading_itself_is_a_cycle) {
  const std::string main = write("main.art", "read sub/../main.art\n");
  EXPECT_EQ(lines_of(read_art(main)), main + ":1:6: error: the file '" + path("sub/../main.art") +
                                          "' reads itself, expected no cycle\n");
}

TEST_F(ReadFiles, nesting_is_limited) {
  const auto chain = [&](int files) {
    for (int i = 0; i < files; ++i) {
      write(std::to_string(i), i + 1 < files ? "read " + std::to_string(i + 1) + "\n" : "soft on");
    }
    return lines_of(read_art(path("0")));
  };
  EXPECT_EQ(chain(128), "");
  EXPECT_EQ(chain(129), path("127") +
                            ":1:6: error: files are nested too deeply, expected at most "
                            "128 inside one another\n");
}

TEST_F(ReadFiles, reading_twice_each_ends) {
  for (int i = 0; i < 100; ++i) {
    const std::string next = std::to_string(i + 1);
    write(std::to_string(i), "read " + next + " " + next + "\n");
  }
  write("100", "");
  const Result<Scene> scene = read_art(path("0"));
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.diagnostics()[0].failure, Failure::limit);
}

TEST_F(ReadFiles, large_files_are_refused) {
  ReadArtOptions options;
  options.max_file_bytes = 20;
  const std::string large = write("large", std::string(21, '\n'));
  Result<Scene> scene = read_art(large, options);
  EXPECT_EQ(lines_of(scene),
            large + ": error: '" + large + "' is too large, expected at most 20 bytes\n");
  EXPECT_EQ(scene.diagnostics()[0].failure, Failure::limit);
  write("x", std::string(20, '\n'));
  const std::string main = write("main", "read x x x x x x x x");
  scene = read_art(main, options);
  EXPECT_EQ(lines_of(scene), main +
                                 ":1:12: error: the files are too large together, expected at "
                                 "most 80 bytes\n");
}

TEST_F(ReadFiles, devices_are_refused) {
  EXPECT_EQ(lines_of(read_art("/dev/zero")),
            "/dev/zero: error: '/dev/zero' is not a regular "
            "file, expected a text file\n");
}

TEST_F(ReadFiles, missing_scenes_and_folders_are_errors) {
  const std::string name = path("none.art");
  EXPECT_EQ(lines_of(read_art(name)),
            name + ": error: there is no file '" + name + "', expected a text file\n");
  EXPECT_EQ(lines_of(read_art(path("sub"))),
            path("sub") + ": error: '" + path("sub") + "' is a directory, expected a text file\n");
}

TEST_F(ReadFiles, can_be_switched_off) {
  ReadArtOptions options;
  options.allow_read = false;
  EXPECT_EQ(said_of("read a.dat\n", options),
            "test.art:1:6: error: 'read' is not allowed here, expected no 'read'\n");
}

TEST(Limits, primitives) {
  ReadArtOptions options;
  options.max_elements = 10;
  std::string text = "surface S radius 1\nobject A\n";
  for (int i = 0; i < 10; ++i) text += "sphere S 1 0 0 0\n";
  EXPECT_EQ(scene_of(text + "close\n", options).elements.size(), 10u);
  for (const char* more : {"sphere S 1 0 0 0\nclose\n", "close\ninstance A B\n"}) {
    const Result<Scene> scene = parse_art(text + more, "f", options);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.diagnostics()[0].failure, Failure::limit);
    EXPECT_TRUE(
        scene.diagnostics()[0].message.ends_with("too many primitives, expected at most 10"))
        << lines_of(scene);
  }
}

TEST(Limits, objects_that_double) {
  std::string text = "object o0\nclose\n";
  for (int i = 1; i < 16; ++i) {
    const std::string n = std::to_string(i);
    text += "object o" + n + "\n";
    for (int k = 0; k < 64; ++k) {
      text += "instance o" + std::to_string(i - 1) + " i" + n + "_" + std::to_string(k) + "\n";
    }
    text += "close\n";
  }
  ReadArtOptions options;
  options.max_elements = 1000;
  const Result<Scene> scene = parse_art(text, "f", options);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.diagnostics()[0].failure, Failure::limit);
}

TEST(Limits, lights) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += "light White\n";
  EXPECT_EQ(scene_of(text).lights.size(), 10000u);
  EXPECT_EQ(said_of(text + "light White\n"),
            "test.art:10001:1: error: too many lights, expected at most 10000\n");
}

TEST(Limits, names) {
  ReadArtOptions options;
  options.max_elements = 3;
  EXPECT_EQ(said_of("var a = 1\nvar b = 1\nvar a = 2\nsurface a\ntexture a moon\n", options),
            "test.art:5:11: error: unknown target of a texture 'moon', expected strength, diffuse, "
            "ambient, specular, reflective, transparent, index, shine, pigment or normal\n");
  for (const char* line : {"surface S\n", "texture T# strength one one\n", "var v# = 1\n"}) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
      std::string copy = line;
      if (const auto at = copy.find('#'); at != std::string::npos) copy[at] = char('0' + i);
      text += copy;
    }
    EXPECT_EQ(said_of(text, options),
              "test.art:4:1: error: too many names, expected at most 3 of a kind\n");
  }
}

}  // namespace
}  // namespace cs2mesh
