// Reads a whole text file into memory.
#pragma once

#include <string>

#include "libfield/base/result.h"

namespace cs2mesh {

/// The bytes of a regular file, or an error at `where` that says what is wrong with it: missing,
/// a directory, unreadable, larger than `max_bytes` (Failure::limit).
Result<std::string> read_file_text(const std::string& path, const SourceLocation& where,
                                   std::size_t max_bytes);

}  // namespace cs2mesh
