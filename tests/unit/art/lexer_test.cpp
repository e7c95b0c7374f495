#include "libfield/art/lexer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cs2mesh {
namespace {

/// Each command as "opcode|argument|...", then the errors.
std::vector<std::string> lex(std::string_view text) {
  DiagnosticLog log;
  Lexer lexer(text, "f", log);
  Command command;
  std::vector<std::string> lines;
  while (lexer.next(command)) {
    std::string line(command.opcode.text);
    for (const Token& token : command.arguments) line += "|" + std::string(token.text);
    lines.push_back(line);
  }
  for (const Diagnostic& d : log.take(false)) lines.push_back(to_string(d));
  return lines;
}

using Lines = std::vector<std::string>;

TEST(Lexer, one_command_a_line) {
  EXPECT_EQ(lex("a b c\n\n  d\te\n"), (Lines{"a|b|c", "d|e"}));
  EXPECT_EQ(lex("a b"), (Lines{"a|b"}));
  EXPECT_EQ(lex(""), Lines{});
  EXPECT_EQ(lex("\n , \n"), Lines{});
}

TEST(Lexer, commas_and_angle_brackets_are_white_space) {
  EXPECT_EQ(lex("plane S,<0 0 1>,<0,0,1>"), (Lines{"plane|S|0|0|1|0|0|1"}));
}

TEST(Lexer, comments_end_a_line) {
  EXPECT_EQ(lex("# a\nb c#d\n#"), (Lines{"b|c"}));
  EXPECT_EQ(lex("a { b # } c\n d }"), (Lines{"a|b|d"}));
}

TEST(Lexer, crlf_and_byte_order_mark) {
  EXPECT_EQ(lex("\xEF\xBB\xBF"
                "a b\r\nc {\r\n d }\r\n"),
            (Lines{"a|b", "c|d"}));
}

TEST(Lexer, braces_continue_over_lines) {
  EXPECT_EQ(lex("a b {\n c,\n\n d\n} # e\nf"), (Lines{"a|b|c|d", "f"}));
  EXPECT_EQ(lex("a{b}"), (Lines{"a|b"}));
  EXPECT_EQ(lex("a { }"), (Lines{"a"}));
}

TEST(Lexer, at_sign_is_dropped) {
  EXPECT_EQ(lex("@echo off\n@ echo on"), (Lines{"echo|off", "echo|on"}));
}

TEST(Lexer, equals_is_a_word) {
  EXPECT_EQ(lex("var r=0.05"), (Lines{"var|r|=|0.05"}));
}

TEST(Lexer, columns_count_characters) {
  const std::string text = "a \xC3\xA9\xC3\xA9 b {\n  c }";
  DiagnosticLog log;
  Lexer lexer(text, "f", log);
  Command command;
  ASSERT_TRUE(lexer.next(command));
  EXPECT_EQ(locate("f", command.arguments[1]), (SourceLocation{"f", 1, 6}));
  EXPECT_EQ(locate("f", command.arguments[2]), (SourceLocation{"f", 2, 3}));
}

TEST(Lexer, goes_on_after_an_error) {
  EXPECT_EQ(lex("a }\nb"),
            (Lines{"b", "f:1:3: error: '}' without a '{', expected a '{' before it"}));
  EXPECT_EQ(lex("a { b\nc { d }\ne"),
            (Lines{"c|d", "e", "f:2:3: error: '{' inside '{', expected a '}' before it"}));
}

TEST(Lexer, words_are_limited) {
  std::string text = "a";
  for (std::size_t i = 0; i < kMaxOperands; ++i) text += " 1";
  EXPECT_EQ(lex(text).front().size(), 1 + 2 * kMaxOperands);
  EXPECT_EQ(lex(text + " 1\nb").front(), "b");
}

TEST(CheckIsText, finds_the_first_byte_that_is_none) {
  EXPECT_FALSE(check_is_text("plain\ttext\r\n \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80", "f"));
  const struct {
    std::string_view text;
    SourceLocation where;
  } kCases[] = {{std::string_view("a\0", 2), {"f", 1, 2}},
                {"a\nb\x1b", {"f", 2, 2}},
                {"\xC0\x80", {"f", 1, 1}},
                {"\xED\xA0\x80", {"f", 1, 1}},
                {"\xE0\x80\x80", {"f", 1, 1}},
                {"\xF4\x90\x80\x80", {"f", 1, 1}},
                {"\xF0\x80\x80\x80", {"f", 1, 1}},
                {"x\xE2\x82", {"f", 1, 2}},
                {"\xFF\xFE", {"f", 1, 1}},
                {"\x80", {"f", 1, 1}}};
  for (const auto& c : kCases) {
    const auto error = check_is_text(c.text, "f");
    ASSERT_TRUE(error) << c.text;
    EXPECT_EQ(error->where, c.where) << c.text;
  }
}

}  // namespace
}  // namespace cs2mesh
