#include "libfield/base/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "cs2mesh-test-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, AppearsOnlyAtCommit) {
  AtomicFile file(path("a.obj"));
  EXPECT_TRUE(file.ok());
  file.write("some ");
  file.write("bytes");
  EXPECT_FALSE(fs::exists(path("a.obj")));
  EXPECT_TRUE(file.commit());
  EXPECT_EQ(content(path("a.obj")), "some bytes");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, LeavesTheFormerFileWhenAbandoned) {
  ASSERT_TRUE(write_file(path("a.obj"), "old"));
  {
    AtomicFile file(path("a.obj"));
    file.write(std::string(3u << 20, 'x'));  // more than one buffer, so that bytes reach the disk
    EXPECT_EQ(entries(), 2u);
  }
  EXPECT_EQ(content(path("a.obj")), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, ReplacesAndKeepsPermissions) {
  ASSERT_TRUE(write_file(path("a.obj"), "old"));
  fs::permissions(path("a.obj"), fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(write_file(path("a.obj"), "new"));
  EXPECT_EQ(content(path("a.obj")), "new");
  EXPECT_EQ(fs::status(path("a.obj")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFileTest, FollowsSymbolicLinks) {
  ASSERT_TRUE(write_file(path("real.obj"), "old"));
  fs::create_symlink("real.obj", path("link.obj"));
  ASSERT_TRUE(write_file(path("link.obj"), "new"));
  EXPECT_TRUE(fs::is_symlink(path("link.obj")));
  EXPECT_EQ(content(path("real.obj")), "new");
}

TEST_F(AtomicFileTest, SaysWhatIsWrong) {
  const auto message = [](const std::string& path) {
    const Result<Done> result = write_file(path, "x");
    EXPECT_FALSE(result);
    EXPECT_EQ(result.diagnostics().front().failure, Failure::output);
    EXPECT_EQ(result.diagnostics().front().where.file, path);
    return result.diagnostics().front().message;
  };
  EXPECT_EQ(message(path("none/a.obj")), "cannot write: no such folder");
  EXPECT_EQ(message(folder_.string()), "cannot write: it is a folder");
  EXPECT_EQ(message("/dev/full"), "cannot write: disk full");
  EXPECT_EQ(entries(), 0u);
}

TEST_F(AtomicFileTest, WritesDevicesInPlace) {
  EXPECT_TRUE(write_file("/dev/null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFileTest, RemovesWhatDidNotFit) {
  ASSERT_TRUE(write_file(path("a.obj"), "old"));
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit small = before;
  small.rlim_cur = 1u << 20;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Result<Done> result = write_file(path("a.obj"), std::string(4u << 20, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.diagnostics().front().message, "cannot write: the file would be too large");
  EXPECT_EQ(content(path("a.obj")), "old");
  EXPECT_EQ(entries(), 1u);
}

}  // namespace
}  // namespace cs2mesh
