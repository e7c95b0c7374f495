#include "libfield/art/file_text.h"

#include <filesystem>
#include <fstream>
#include <system_error>

namespace cs2mesh {
namespace fs = std::filesystem;

Result<std::string> read_file_text(const std::string& path, const SourceLocation& where,
                                   std::size_t max_bytes) {
  const std::string file = "'" + path + "'";
  // Only regular files: a pipe or device may never end.
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return error_at(where, "there is no file " + file + ", expected a text file");
  }
  if (status.type() == fs::file_type::directory) {
    return error_at(where, file + " is a directory, expected a text file");
  }
  if (error || status.type() != fs::file_type::regular) {
    return error_at(where, file + " is not a regular file, expected a text file");
  }
  const auto too_large = [&] {
    return error_at(
        where, file + " is too large, expected at most " + std::to_string(max_bytes) + " bytes",
        Failure::limit);
  };
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size > max_bytes) return too_large();
  std::ifstream stream(path, std::ios::binary);
  std::string text(error ? 0 : static_cast<std::size_t>(size), '\0');
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (error || !stream) {
    return error_at(where, file + " cannot be read, expected a readable text file");
  }
  return text;
}

}  // namespace cs2mesh
