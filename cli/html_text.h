// Pieces of HTML that hold anything.
#pragma once

#include <string>
#include <string_view>

namespace cs2mesh {

/// The words so that HTML shows them as they are, as text and within a quoted attribute; control
/// characters become '_'.
std::string escape_html(std::string_view words);

/// RFC 4648, padded.
std::string encode_base64(std::string_view bytes);

/// `data:TYPE;base64,...`: a file's content in place of its address.
std::string data_uri(std::string_view media_type, std::string_view bytes);

}  // namespace cs2mesh
