// The output files of a run: all of them appear, whole, or none does.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "libfield/base/result.h"

namespace cs2mesh {

/// Files are written by the names that they will have into a folder beside their place (writers may
/// put more files there, as OBJ does), and moved to it when all are complete.
class OutputFiles {
 public:
  /// Writes a file at the path that it is given.
  using Writer = std::function<Result<Done>(const std::string& path)>;

  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Whether a file at `path` could be written, as far as one can tell without doing it: to be
  /// asked before hours of work. Error: Failure::output, located at the path.
  static Result<Done> can_write(const std::string& path);

  /// Whether two paths are one regular file, or will be when it is written; what is no regular file
  /// (a pipe, /dev/null) can be written to twice.
  static bool same_file(const std::string& a, const std::string& b);

  /// Whether the name ends with `extension`, dot included. Error: Failure::bad_input, at the path.
  static Result<Done> has_extension(const std::string& path, const std::string& extension);

  /// Writes one output. What is no regular file (a pipe, /dev/null) is written in place at once.
  Result<Done> write(const std::string& path, const Writer& writer);

  /// Moves all files to their places, or on an error none: files that were there before are then
  /// there again. To be called once. Failure::interrupted after Ctrl-C.
  Result<Done> commit();

 private:
  struct Move {
    std::string from, to, backup;
    bool done = false;
  };
  std::string staging_folder(const std::string& parent);
  void undo();

  struct Staging {
    std::string parent, folder;
  };
  std::vector<Staging> staging_;
  std::vector<Move> moves_;
};

}  // namespace cs2mesh
