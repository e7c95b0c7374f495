// Typed reading of a command's arguments, with variables in place of values.
//
// The first mistake is reported at its word and makes the reader fail: from then on every call
// returns a harmless value and says nothing, so a handler reads all it needs and asks once, with
// finish(), whether to act.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "libfield/art/diagnostic_log.h"
#include "libfield/art/lexer.h"
#include "libfield/art/symbols.h"

namespace cs2mesh {

/// A colour, or a percentage of some other colour.
struct ColorArgument {
  bool is_percentage = false;
  double share = 0.0;  ///< of a percentage, 0..
  Color color;
};

class Arguments {
 public:
  Arguments(const Command& command, const std::string& file, const Symbols& symbols,
            DiagnosticLog& log)
      : command_(&command), file_(&file), symbols_(&symbols), log_(&log) {}

  std::string_view opcode() const { return command_->opcode.text; }
  SourceLocation opcode_location() const { return locate(*file_, command_->opcode); }

  /// True while arguments are left and none was wrong.
  bool more() const { return !failed_ && next_ < command_->arguments.size(); }
  /// How many arguments are left, whatever they are.
  std::size_t left() const { return command_->arguments.size() - next_; }
  /// The next word, "" when more() is false.
  std::string_view peek() const { return more() ? command_->arguments[next_].text : ""; }
  /// Where the next word begins, or where the command ends.
  SourceLocation here() const;

  /// Any word. `what` is what stands there, for the message: "the name of a surface".
  std::string_view word(std::string_view what);
  double number(std::string_view what);
  double positive(std::string_view what);
  double not_negative(std::string_view what);
  int integer(std::string_view what, int least, int most);
  /// Three numbers or a vector variable.
  Vec3d triple(std::string_view what);
  /// A triple that is not zero, made a unit vector.
  Vec3d direction(std::string_view what);
  /// Three numbers, a vector or colour variable, or a colour's name; components of any sign.
  Vec3d rgb(std::string_view what);
  /// As rgb, no component negative.
  Color color(std::string_view what);
  /// As color, or a percentage.
  ColorArgument color_or_percentage(std::string_view what);
  /// Index of the keyword of which the next word is an unambiguous prefix.
  std::size_t keyword(std::span<const std::string_view> keywords, std::string_view what);
  /// Whether the next word is a prefix of `keyword`, at least `least` long; then it is taken.
  bool take_if(std::string_view keyword, std::size_t least);
  /// Whether the last word of the command, not yet taken, is `word`.
  bool last_is(std::string_view word) const {
    return left() > 0 && command_->arguments.back().text == word;
  }
  /// Takes the word that peek() shows.
  void skip() { ++next_; }

  /// Reports at `where` unless something was reported before; fails from now on.
  void fail(const SourceLocation& where, const std::string& message,
            Failure failure = Failure::bad_input);
  bool failed() const { return failed_; }
  /// False after any mistake, and where words are left over, which is reported.
  bool finish();

  const Symbols& symbols() const { return *symbols_; }

 private:
  SourceLocation location(std::size_t index) const;
  bool expect(std::string_view what);
  /// The number that a word stands for: digits or a scalar variable; fails otherwise.
  double scalar_of(const Token& token, std::string_view what);
  void fail_as(const Token& token, std::string_view what);
  const Value* variable() const;

  const Command* command_;
  const std::string* file_;
  const Symbols* symbols_;
  DiagnosticLog* log_;
  std::size_t next_ = 0;
  bool failed_ = false;
};

}  // namespace cs2mesh
