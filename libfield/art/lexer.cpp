#include "libfield/art/lexer.h"

#include <array>
#include <utility>

#include "libfield/base/result.h"

namespace cs2mesh {
namespace {

enum class Class : unsigned char { word, space, line_end, comment, open, close, equals };

constexpr std::array<Class, 256> kClassOf = [] {
  std::array<Class, 256> table{};
  for (const unsigned char c : {' ', '\t', '\r', '\f', '\v', ',', '<', '>'}) {
    table[c] = Class::space;
  }
  table['\n'] = Class::line_end;
  table['#'] = Class::comment;
  table['{'] = Class::open;
  table['}'] = Class::close;
  table['='] = Class::equals;
  return table;
}();

Class class_of(char c) {
  return kClassOf[static_cast<unsigned char>(c)];
}

bool is_continuation(unsigned char c) {
  return (c & 0xC0) == 0x80;
}

/// Length of the well-formed UTF-8 sequence at the start of `text`, 0 if there is none (RFC 3629:
/// shortest form, no surrogates, at most U+10FFFF).
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(byte(i))) return 0;
  }
  if (first == 0xE0 && byte(1) < 0xA0) return 0;
  if (first == 0xED && byte(1) >= 0xA0) return 0;
  if (first == 0xF0 && byte(1) < 0x90) return 0;
  if (first == 0xF4 && byte(1) >= 0x90) return 0;
  return length;
}

bool is_control(unsigned char c) {
  return (c < 0x20 && !(c >= '\t' && c <= '\r')) || c == 0x7F;
}

}  // namespace

SourceLocation locate(const std::string& file, const Token& token) {
  int column = 1;
  for (const char* p = token.line_begin; p < token.text.data(); ++p) {
    if (!is_continuation(static_cast<unsigned char>(*p))) ++column;
  }
  return {file, token.line, column};
}

std::optional<Diagnostic> check_is_text(std::string_view text, const std::string& file) {
  int line = 1;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t length = c < 0x80 ? 1 : sequence_length(text.substr(i));
    if (length == 0 || is_control(c)) {
      const Token here{text.substr(i, 1), text.data() + line_begin, line};
      return error_at(locate(file, here),
                      length == 0 ? "this is not UTF-8, expected a text file"
                                  : "this is a control character, expected a text file");
    }
    i += length;
    if (c == '\n') {
      ++line;
      line_begin = i;
    }
  }
  return std::nullopt;
}

Lexer::Lexer(std::string_view text, std::string file, DiagnosticLog& log, int first_line)
    : file_(std::move(file)), log_(&log), line_(first_line) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  at_ = text.data();
  end_ = text.data() + text.size();
  line_begin_ = at_;
}

Token Lexer::token_at(const char* begin, std::size_t length) const {
  return {{begin, length}, line_begin_, line_};
}

void Lexer::skip_line() {
  while (at_ < end_ && *at_ != '\n') ++at_;
}

/// Moves past the next piece of the text. At a line end, the next line has begun.
Lexer::Step Lexer::scan(Token& token) {
  while (at_ < end_ && class_of(*at_) == Class::space) ++at_;
  if (at_ == end_) {
    token = token_at(at_, 0);
    return Step::text_end;
  }
  const char* const begin = at_;
  switch (class_of(*at_)) {
    case Class::comment:
      skip_line();
      return scan(token);
    case Class::line_end:
      token = token_at(at_, 0);
      line_begin_ = ++at_;
      ++line_;
      return Step::line_end;
    case Class::open:
      token = token_at(at_++, 1);
      return Step::open;
    case Class::close:
      token = token_at(at_++, 1);
      return Step::close;
    case Class::equals:
      token = token_at(at_++, 1);
      return Step::word;
    default:
      break;
  }
  while (at_ < end_ && class_of(*at_) == Class::word) ++at_;
  token = token_at(begin, static_cast<std::size_t>(at_ - begin));
  return Step::word;
}

bool Lexer::add(Command& command, const Token& token) {
  if (command.arguments.size() == kMaxOperands) {
    log_->error(locate(file_, token), "too many words, expected at most " +
                                          std::to_string(kMaxOperands) + " after a command");
    return false;
  }
  command.arguments.push_back(token);
  return true;
}

bool Lexer::next(Command& command) {
  for (;;) {
    Token token;
    const Step step = scan(token);
    if (step == Step::text_end) return false;
    if (step == Step::line_end) continue;
    if (step != Step::word) {
      log_->error(locate(file_, token),
                  in_quotes(token.text) + " without a command, expected a command before it");
      skip_line();
      continue;
    }
    if (token.text.front() == '@') {
      token.text.remove_prefix(1);
      if (token.text.empty() && scan(token) != Step::word) {
        log_->error(locate(file_, token), "'@' alone, expected a command after it");
        if (token.text.empty()) continue;
        skip_line();
        continue;
      }
    }
    command.opcode = token;
    command.arguments.clear();
    if (read_arguments(command)) return true;
  }
}

bool Lexer::read_arguments(Command& command) {
  for (;;) {
    Token token;
    switch (scan(token)) {
      case Step::line_end:
      case Step::text_end:
        return true;
      case Step::word:
        if (!add(command, token)) {
          skip_line();
          return false;
        }
        break;
      case Step::close:
        log_->error(locate(file_, token), "'}' without a '{', expected a '{' before it");
        skip_line();
        return false;
      case Step::open:
        return read_block(command, token);
    }
  }
}

/// Reads from behind `open` to its `}` and the end of that line.
bool Lexer::read_block(Command& command, const Token& open) {
  bool good = true;
  Token token;
  for (Step step = scan(token); step != Step::close; step = scan(token)) {
    if (step == Step::text_end) {
      log_->error(locate(file_, open), "'{' is never closed, expected a '}'");
      return false;
    }
    if (step == Step::open) {
      // The first '{' lacks its '}' most likely: the line of the second is a command again.
      log_->error(locate(file_, token), "'{' inside '{', expected a '}' before it");
      if (token.line != open.line) {
        at_ = line_begin_;
      } else {
        skip_line();
      }
      return false;
    }
    if (step == Step::word && good) good = add(command, token);
  }
  const Step step = scan(token);
  if (step == Step::word || step == Step::open || step == Step::close) {
    if (good) {
      log_->error(locate(file_, token), "unexpected " + in_quotes(token.text) +
                                            " behind '}', expected the end of the line");
    }
    skip_line();
    return false;
  }
  return good;
}

}  // namespace cs2mesh
