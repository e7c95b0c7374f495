// Output files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/result.h"

namespace cs2mesh {

/// Writes a file under a temporary name in its folder; commit() flushes it to the disk and renames
/// it. Destruction without a successful commit() removes what was written and leaves a former file
/// of that name as it was. The first error is kept and later writes are ignored, so a writer needs
/// to look at commit() alone; ok() right after construction tells early whether the folder can be
/// written.
///
/// A symbolic link is followed. What is no regular file (a terminal, a pipe, /dev/null) is written
/// in place. Not promised: clean-up when the process is killed between construction and commit().
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  bool ok() const { return error_ == 0; }
  /// Error: Failure::output, located at the file, with a message such as "cannot write: disk full".
  /// To be called once.
  Result<Done> commit();

 private:
  void open();
  void flush();
  void fail(int error);
  void discard();

  std::string path_;       ///< as the user named it
  std::string target_;     ///< with symbolic links resolved
  std::string temporary_;  ///< empty when writing in place or when nothing is left to remove
  std::string buffer_;
  int descriptor_ = -1;
  int error_ = 0;
};

/// Replaces the file at `path` by `bytes`. Errors as AtomicFile::commit.
Result<Done> write_file(const std::string& path, std::string_view bytes);

}  // namespace cs2mesh
