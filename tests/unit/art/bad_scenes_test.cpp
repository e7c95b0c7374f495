// Every broken scene of data/bad gives exactly the output beside it, and together they show every
// error that the reader can report.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "libfield/art/read_art.h"
#include "libfield/field/compile.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = CS2MESH_SOURCE_DIR;

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<fs::path> files_in(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The first failure of a scene on its way to a mesher; all is well if there is none.
std::vector<Diagnostic> errors_of(const std::string& name) {
  const Result<Scene> scene = read_art(name);
  if (!scene) return scene.diagnostics();
  const Result<CompiledScene> compiled = compile(*scene);
  if (!compiled) return compiled.diagnostics();
  const Result<CompiledScene> clipped = clip_to_bounds(*compiled, *scene);
  return clipped ? std::vector<Diagnostic>{} : clipped.diagnostics();
}

/// What `cs2mesh NAME.art` says, with its exit status in the first line.
std::string outcome(const std::string& name) {
  std::string lines;
  int status = 0;
  for (const Diagnostic& d : errors_of(name)) {
    if (d.severity != Severity::error) continue;
    lines += to_string(d) + "\n";
    if (status == 0) {
      status = d.failure == Failure::limit ? 6 : d.failure == Failure::unmeshable ? 3 : 2;
    }
  }
  return "status " + std::to_string(status) + "\n" + lines;
}

class BadScenes : public testing::Test {
 protected:
  // The files are named relative to data/bad in the expected output.
  void SetUp() override { fs::current_path(kRoot / "data" / "bad"); }
  void TearDown() override { fs::current_path(before_); }

 private:
  fs::path before_ = fs::current_path();
};

TEST_F(BadScenes, give_the_expected_output) {
  const std::vector<fs::path> scenes = files_in(".", ".art");
  EXPECT_GE(scenes.size(), 50u);
  for (const fs::path& scene : scenes) {
    const std::string name = scene.filename().string();
    const fs::path expected = fs::path(name).replace_extension(".expected");
    EXPECT_EQ(outcome(name), text_of(expected)) << name;
  }
}

TEST_F(BadScenes, every_expected_output_has_its_scene) {
  for (const fs::path& expected : files_in(".", ".expected")) {
    EXPECT_TRUE(fs::exists(fs::path(expected).replace_extension(".art"))) << expected;
  }
}

/// Errors that no small file can cause; the tests named here show them.
const std::vector<std::string> kShownElsewhere = {
    " is not a regular file, expected a text file",         // ReadFiles.devices_are_refused
    " is too large, expected at most ",                     // ReadFiles.large_files_are_refused
    " cannot be read, expected a readable text file",       // no such file for the superuser
    "the files are too large together, expected at most ",  // ReadFiles.large_files_are_refused
    "files are nested too deeply, expected at most ",       // ReadFiles.nesting_is_limited
    "'read' is not allowed here, expected no 'read'",       // ReadFiles.can_be_switched_off
    "this is not text, expected name=value",                // Defines.broken_ones_are_reported
    "found another line, expected a value",                 // Defines.broken_ones_are_reported
    "too many lights, expected at most ",                   // Limits.lights
    "too many names, expected at most ",                    // Limits.names
    ", expected at most ",                                  // Limits.primitives
};

TEST_F(BadScenes, show_every_error_of_the_reader) {
  std::string shown;
  for (const fs::path& expected : files_in(".", ".expected")) shown += text_of(expected);
  for (const std::string& text : kShownElsewhere) shown += text;
  const std::regex literal(R"re("((?:[^"\\]|\\.)*)")re");
  int checked = 0;
  for (const fs::path& source : files_in(kRoot / "libfield" / "art", ".cpp")) {
    const std::string code = text_of(source);
    for (std::sregex_iterator it(code.begin(), code.end(), literal), end; it != end; ++it) {
      const std::string text = (*it)[1];
      if (text.find("expected ") == std::string::npos) continue;
      ++checked;
      EXPECT_NE(shown.find(text), std::string::npos) << source << ": " << text;
    }
  }
  EXPECT_GT(checked, 50);
}

}  // namespace
}  // namespace cs2mesh
