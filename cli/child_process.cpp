#include "cli/child_process.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>
#include <thread>

#include "cli/interrupt.h"
#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// A file in memory that goes with its descriptor. Where a pipe would have to be filled and emptied
/// while the child runs, files are written before and read after.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("cs2mesh", MFD_CLOEXEC)) {}
  ~MemoryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }

  std::size_t size() const {
    struct stat status = {};
    return ::fstat(descriptor_, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
  }

  /// Leaves the file's place at its beginning.
  bool fill(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return ::lseek(descriptor_, 0, SEEK_SET) == 0;
  }

  std::string content() const {
    std::string bytes(size(), '\0');
    std::size_t filled = 0;
    while (filled < bytes.size()) {
      const ssize_t count = ::pread(descriptor_, bytes.data() + filled, bytes.size() - filled,
                                    static_cast<off_t>(filled));
      if (count <= 0) break;
      filled += static_cast<std::size_t>(count);
    }
    bytes.resize(filled);
    return bytes;
  }

 private:
  int descriptor_;
};

Diagnostic child_error(const std::string& program, const std::string& what) {
  return error_at({}, program + " " + what, Failure::output);
}

std::string first_line(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_first_of("\r\n", begin) - begin);
}

/// 0, or the error number.
int spawn(const std::vector<std::string>& words, const MemoryFile& in, const MemoryFile& out,
          const MemoryFile& err, pid_t& child) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  // The interface is older than const; the words are not written to.
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  if (const int error = ::posix_spawn_file_actions_init(&actions); error != 0) return error;
  int error = ::posix_spawn_file_actions_adddup2(&actions, in.descriptor(), STDIN_FILENO);
  if (error == 0) {
    error = ::posix_spawn_file_actions_adddup2(&actions, out.descriptor(), STDOUT_FILENO);
  }
  if (error == 0) {
    error = ::posix_spawn_file_actions_adddup2(&actions, err.descriptor(), STDERR_FILENO);
  }
  if (error == 0) {
    error = ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  }
  ::posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// Waits until the child has ended; what it was stopped for, if it was.
std::string wait_for(pid_t child, const MemoryFile& out, const MemoryFile& err,
                     const ChildLimits& limits, int& status) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  std::string stopped;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, stopped.empty() ? WNOHANG : 0);
    if (ended == child || (ended < 0 && errno != EINTR)) return stopped;
    if (!stopped.empty()) continue;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (interrupted()) {
      stopped = "was interrupted";
    } else if (seconds > limits.seconds) {
      stopped = "takes too long";
    } else if (out.size() + err.size() > limits.output_bytes) {
      stopped = "says too much";
    }
    if (!stopped.empty()) {
      ::kill(child, SIGKILL);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

}  // namespace

Result<std::string> run_child(const std::vector<std::string>& words, std::string_view input,
                              const ChildLimits& limits) {
  require(!words.empty(), "run_child: a program");
  const std::string& program = words.front();
  const MemoryFile in, out, err;
  if (in.descriptor() < 0 || out.descriptor() < 0 || err.descriptor() < 0 || !in.fill(input)) {
    return child_error(program, "cannot be given its input");
  }
  pid_t child = -1;
  if (const int error = spawn(words, in, out, err, child); error != 0) {
    return child_error(program, "cannot be run: " + std::generic_category().message(error));
  }
  int status = 0;
  const std::string stopped = wait_for(child, out, err, limits, status);
  if (interrupted()) return error_at({}, "interrupted", Failure::interrupted);
  if (!stopped.empty()) return child_error(program, stopped);
  if (WIFSIGNALED(status)) return child_error(program, "was killed");
  if (WEXITSTATUS(status) != 0) {
    const std::string why = first_line(err.content());
    return child_error(program, why.empty() ? "failed" : "failed: " + why);
  }
  return out.content();
}

}  // namespace cs2mesh
