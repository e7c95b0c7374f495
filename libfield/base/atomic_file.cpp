#include "libfield/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <system_error>
#include <utility>

namespace cs2mesh {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

std::string words_for(int error) {
  switch (error) {
    case ENOSPC:
      return "disk full";
    case EDQUOT:
      return "disk quota used up";
    case EACCES:
    case EPERM:
      return "permission denied";
    case EROFS:
      return "the file system is read-only";
    case ENOENT:
    case ENOTDIR:
      return "no such folder";
    case EISDIR:
      return "it is a folder";
    case EFBIG:
      return "the file would be too large";
    default:
      return std::generic_category().message(error);
  }
}

std::string resolved(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr),
                                                         &std::free);
  return real ? std::string(real.get()) : path;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
}

/// A fresh file in `folder`, name in `name`; -1 with errno set on failure.
int create_temporary(const std::string& folder, std::string& name) {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 1000;  // names left by killed processes with the same number
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // A short name of its own: the final name with a suffix could be too long for the folder.
    name = folder + ".cs2mesh-" + std::to_string(::getpid()) + '-' +
           std::to_string(counter.fetch_add(1)) + ".tmp";
    const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), target_(resolved(path_)) {
  open();
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::open() {
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return fail(EISDIR);
  if (exists && ::access(target_.c_str(), W_OK) != 0) return fail(errno);
  if (exists && !S_ISREG(status.st_mode)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  descriptor_ = create_temporary(folder_of(target_), temporary_);
  if (descriptor_ < 0) {
    temporary_.clear();
    return fail(errno);
  }
  // Best effort: a file that is replaced keeps its permissions.
  if (exists && ::fchmod(descriptor_, status.st_mode & 07777) != 0) errno = 0;
}

void AtomicFile::write(std::string_view bytes) {
  if (!ok()) return;
  buffer_.append(bytes);
  if (buffer_.size() >= kBufferBytes) flush();
}

void AtomicFile::flush() {
  std::string_view rest = buffer_;
  while (ok() && !rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      fail(errno);
    }
  }
  buffer_.clear();
}

Result<Done> AtomicFile::commit() {
  flush();
  // A full disk may show only when the data are forced out; terminals and pipes cannot be synced.
  if (ok() && !temporary_.empty() && ::fsync(descriptor_) != 0) fail(errno);
  if (descriptor_ >= 0 && ::close(std::exchange(descriptor_, -1)) != 0 && ok()) fail(errno);
  if (ok() && !temporary_.empty()) {
    if (::rename(temporary_.c_str(), target_.c_str()) == 0) {
      temporary_.clear();
    } else {
      fail(errno);
    }
  }
  if (ok()) return Done{};
  discard();
  return error_at({path_}, "cannot write: " + words_for(error_), Failure::output);
}

void AtomicFile::fail(int error) {
  if (error_ == 0) error_ = error != 0 ? error : EIO;
}

void AtomicFile::discard() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

Result<Done> write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  return file.commit();
}

}  // namespace cs2mesh
