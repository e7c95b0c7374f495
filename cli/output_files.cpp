#include "cli/output_files.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cli/interrupt.h"

namespace cs2mesh {
namespace {

namespace fs = std::filesystem;

Diagnostic cannot_write(const std::string& path, const std::string& why) {
  return error_at({path, 0, 0}, "cannot write: " + why, Failure::output);
}

/// The place of the file with symbolic links followed, as far as it exists.
fs::path resolved(const std::string& path) {
  std::error_code error;
  fs::path real = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? fs::path(path) : real;
}

bool is_special(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

}  // namespace

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const Staging& staging : staging_) fs::remove_all(staging.folder, ignored);
}

Result<Done> OutputFiles::can_write(const std::string& path) {
  const fs::path target = resolved(path);
  std::error_code error;
  if (path.empty() || path.back() == '/' || fs::is_directory(target, error)) {
    return cannot_write(path, "it is a folder");
  }
  if (fs::exists(target, error)) {
    if (::access(target.c_str(), W_OK) != 0) return cannot_write(path, "permission denied");
    if (is_special(target)) return Done{};
  }
  if (!fs::is_directory(target.parent_path(), error)) return cannot_write(path, "no such folder");
  if (::access(target.parent_path().c_str(), W_OK) != 0) {
    return cannot_write(path, "its folder cannot be written to");
  }
  return Done{};
}

bool OutputFiles::same_file(const std::string& a, const std::string& b) {
  const fs::path place = resolved(a);
  return place == resolved(b) && !is_special(place);
}

Result<Done> OutputFiles::has_extension(const std::string& path, const std::string& extension) {
  if (path.ends_with(extension)) return Done{};
  return error_at({path, 0, 0}, "expected a file name that ends with " + extension);
}

std::string OutputFiles::staging_folder(const std::string& parent) {
  for (const Staging& staging : staging_) {
    if (staging.parent == parent) return staging.folder;
  }
  std::string folder = parent + "/.cs2mesh-" + std::to_string(::getpid()) + ".tmp";
  std::error_code error;
  if (!fs::create_directory(folder, error)) return "";
  staging_.push_back({parent, folder});
  return folder;
}

Result<Done> OutputFiles::write(const std::string& path, const Writer& writer) {
  const fs::path target = resolved(path);
  if (is_special(target)) return writer(path);
  const std::string folder = staging_folder(target.parent_path().string());
  if (folder.empty()) return cannot_write(path, "its folder cannot be written to");

  const auto relocated = [&](std::vector<Diagnostic> diagnostics) {
    for (Diagnostic& diagnostic : diagnostics) {
      if (diagnostic.where.file.starts_with(folder)) diagnostic.where.file = path;
    }
    return diagnostics;
  };
  Result<Done> result = writer(folder + "/" + target.filename().string());
  if (!result) return Result<Done>::failure(relocated(result.diagnostics()));

  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string from = entry.path().string();
    const bool known = std::any_of(moves_.begin(), moves_.end(),
                                   [&](const Move& move) { return move.from == from; });
    if (known) continue;
    moves_.push_back({from, (target.parent_path() / entry.path().filename()).string(), "", false});
  }
  return {Done{}, relocated(result.diagnostics())};
}

Result<Done> OutputFiles::commit() {
  if (interrupted()) {
    return error_at({}, "interrupted; nothing was written", Failure::interrupted);
  }
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    Move& move = moves_[i];
    std::error_code error;
    if (fs::exists(move.to, error)) {
      // A second name for the former file, to bring it back by; a file system without hard links
      // goes without.
      const std::string backup = move.from + ".former-" + std::to_string(i);
      fs::create_hard_link(move.to, backup, error);
      if (!error) move.backup = backup;
      fs::permissions(move.from, fs::status(move.to, error).permissions(), error);
    }
    fs::rename(move.from, move.to, error);
    if (error) {
      undo();
      return cannot_write(move.to, error.message());
    }
    move.done = true;
  }
  return Done{};
}

void OutputFiles::undo() {
  for (const Move& move : moves_) {
    if (!move.done) continue;
    std::error_code ignored;
    if (move.backup.empty()) {
      fs::remove(move.to, ignored);
    } else {
      fs::rename(move.backup, move.to, ignored);
    }
  }
}

}  // namespace cs2mesh
