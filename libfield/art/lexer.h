// .art text -> commands: an opcode with its argument words.
//
// One command a line. `#` starts a comment, `,` `<` `>` are white space, `{` lets the arguments run
// over several lines until `}`, `=` is a word of its own, a leading `@` is dropped.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/art/diagnostic_log.h"

namespace cs2mesh {

/// A word of the text, with what is needed to say where it stands.
struct Token {
  std::string_view text;
  const char* line_begin = nullptr;  ///< of the line that holds the word
  int line = 0;                      ///< from 1
};

/// Where the token begins; columns count UTF-8 characters from 1.
SourceLocation locate(const std::string& file, const Token& token);

/// One command; reused from line to line so that it does not allocate.
struct Command {
  Token opcode;
  std::vector<Token> arguments;
};

/// Most words a command may have after its opcode (thesis C.2, restrictions).
inline constexpr std::size_t kMaxOperands = 512;

/// The first byte of `text` that no text has: a control character, or what is not UTF-8.
std::optional<Diagnostic> check_is_text(std::string_view text, const std::string& file);

class Lexer {
 public:
  /// Lines count from `first_line`; 0 where the text is no file and has no lines to point to.
  /// Keeps views of `text`, which must outlive the lexer and its tokens; a UTF-8 byte order mark is
  /// skipped. `text` has passed check_is_text.
  Lexer(std::string_view text, std::string file, DiagnosticLog& log, int first_line = 1);

  /// Reads the next command; false at the end of the text. A command that is broken as a text is
  /// reported and skipped. O(length of the command).
  bool next(Command& command);

  const std::string& file() const { return file_; }

 private:
  enum class Step { word, open, close, line_end, text_end };
  Step scan(Token& token);
  void skip_line();
  bool read_arguments(Command& command);
  bool read_block(Command& command, const Token& open);
  bool add(Command& command, const Token& token);
  Token token_at(const char* begin, std::size_t length) const;

  std::string file_;
  DiagnosticLog* log_;
  const char* at_;
  const char* end_;
  const char* line_begin_;
  int line_;
};

}  // namespace cs2mesh
