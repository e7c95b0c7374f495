#include "libfield/art/arguments.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libfield/art/colors.h"
#include "libfield/art/number.h"

namespace cs2mesh {
namespace {

bool looks_like_number(std::string_view text) {
  const char c = text.front();
  return (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '+';
}

/// The unit vector along `v`, safe from overflow and underflow of squares; zero for zero.
Vec3d unit(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest > 0 ? normalized(v / largest) : Vec3d{};
}

std::string list_of(std::span<const std::string_view> words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) list += i + 1 == words.size() ? " or " : ", ";
    list += words[i];
  }
  return list;
}

std::string text_of(std::string_view what) {
  return std::string(what);
}

}  // namespace

SourceLocation Arguments::here() const {
  return location(next_);
}

SourceLocation Arguments::location(std::size_t index) const {
  if (index < command_->arguments.size()) return locate(*file_, command_->arguments[index]);
  const Token& last = command_->arguments.empty() ? command_->opcode : command_->arguments.back();
  Token behind = last;
  behind.text = last.text.substr(last.text.size());
  return locate(*file_, behind);
}

void Arguments::fail(const SourceLocation& where, const std::string& message, Failure failure) {
  if (!failed_) log_->error(where, message, failure);
  failed_ = true;
}

void Arguments::fail_as(const Token& token, std::string_view what) {
  std::vector<std::string_view> candidates;
  if (!looks_like_number(token.text)) candidates = names_of(symbols_->variables);
  fail(locate(*file_, token), in_quotes(token.text) + " is not a number, expected " +
                                  text_of(what) + did_you_mean(token.text, candidates));
}

bool Arguments::expect(std::string_view what) {
  if (failed_) return false;
  if (more()) return true;
  fail(here(), "the command ends too early, expected " + text_of(what));
  return false;
}

bool Arguments::finish() {
  if (more()) {
    fail(here(), "unexpected " + in_quotes(peek()) + ", expected the end of the command");
  }
  return !failed_;
}

const Value* Arguments::variable() const {
  return find(symbols_->variables, command_->arguments[next_].text);
}

std::string_view Arguments::word(std::string_view what) {
  return expect(what) ? command_->arguments[next_++].text : "";
}

double Arguments::scalar_of(const Token& token, std::string_view what) {
  const ParsedNumber parsed = parse_number(token.text);
  if (parsed.status == NumberStatus::ok) return parsed.value;
  if (parsed.status == NumberStatus::overflow) {
    fail(locate(*file_, token), in_quotes(token.text) + " is too large, expected " + text_of(what) +
                                    " within the range of double precision");
    return 1.0;
  }
  if (const Value* value = find(symbols_->variables, token.text)) {
    if (const double* scalar = std::get_if<double>(value)) return *scalar;
    if (std::holds_alternative<BrokenValue>(*value)) {
      failed_ = true;
      return 1.0;
    }
    fail(locate(*file_, token),
         "the variable " + in_quotes(token.text) + " is not a scalar, expected " + text_of(what));
    return 1.0;
  }
  fail_as(token, what);
  return 1.0;
}

double Arguments::number(std::string_view what) {
  return expect(what) ? scalar_of(command_->arguments[next_++], what) : 1.0;
}

double Arguments::positive(std::string_view what) {
  const std::size_t at = next_;
  const std::string_view word = peek();
  const double value = number(what);
  if (failed_ || value > 0) return failed_ ? 1.0 : value;
  fail(location(at), in_quotes(word) + " is out of range, expected " + text_of(what) + " > 0");
  return 1.0;
}

double Arguments::not_negative(std::string_view what) {
  const std::size_t at = next_;
  const std::string_view word = peek();
  const double value = number(what);
  if (failed_ || value >= 0) return failed_ ? 1.0 : value;
  fail(location(at), in_quotes(word) + " is out of range, expected " + text_of(what) + " >= 0");
  return 1.0;
}

int Arguments::integer(std::string_view what, int least, int most) {
  const std::size_t at = next_;
  const std::string_view word = peek();
  const double value = number(what);
  if (failed_) return least;
  if (value >= least && value <= most && value == std::floor(value)) {
    return static_cast<int>(value);
  }
  fail(location(at), in_quotes(word) + " is out of range, expected " + text_of(what) +
                         ", a whole number " + std::to_string(least) + " to " +
                         std::to_string(most));
  return least;
}

Vec3d Arguments::triple(std::string_view what) {
  if (!expect(what)) return {0, 0, 1};
  if (const Value* value = variable()) {
    if (const Vec3d* vector = std::get_if<Vec3d>(value)) {
      ++next_;
      return *vector;
    }
  }
  Vec3d v;
  for (std::size_t axis = 0; axis < 3; ++axis) v[axis] = number(what);
  return failed_ ? Vec3d{0, 0, 1} : v;
}

Vec3d Arguments::direction(std::string_view what) {
  const std::size_t at = next_;
  const Vec3d v = triple(what);
  if (!failed_ && v == Vec3d{}) {
    fail(location(at),
         "the zero vector has no direction, expected " + text_of(what) + " other than zero");
  }
  return failed_ ? Vec3d{0, 0, 1} : unit(v);
}

Vec3d Arguments::rgb(std::string_view what) {
  if (!expect(what)) return {};
  const Token& token = command_->arguments[next_];
  if (looks_like_number(token.text)) return triple(what);
  if (const Value* value = variable()) {
    if (const Color* color = std::get_if<Color>(value)) {
      ++next_;
      return {color->r, color->g, color->b};
    }
    return triple(what);
  }
  if (const auto color = color_of(token.text)) {
    ++next_;
    return {color->r, color->g, color->b};
  }
  std::vector<std::string_view> candidates = names_of(symbols_->variables);
  candidates.insert(candidates.end(), color_names().begin(), color_names().end());
  fail(locate(*file_, token), "unknown color " + in_quotes(token.text) + ", expected " +
                                  text_of(what) + did_you_mean(token.text, candidates));
  return {};
}

Color Arguments::color(std::string_view what) {
  const std::size_t at = next_;
  const Vec3d c = rgb(what);
  if (!failed_ && (c.x < 0 || c.y < 0 || c.z < 0)) {
    fail(location(at), "a color has no negative component, expected " + text_of(what) + " >= 0");
  }
  return {c.x, c.y, c.z};
}

ColorArgument Arguments::color_or_percentage(std::string_view what) {
  const std::string_view text = peek();
  if (text.size() < 2 || text.back() != '%') return {false, 0.0, color(what)};
  Token token = command_->arguments[next_++];
  token.text.remove_suffix(1);
  const double percentage = scalar_of(token, what);
  if (!failed_ && percentage < 0) {
    fail(locate(*file_, token),
         in_quotes(text) + " is out of range, expected " + text_of(what) + ", a percentage >= 0");
  }
  return {true, percentage / 100.0, {}};
}

std::size_t Arguments::keyword(std::span<const std::string_view> keywords, std::string_view what) {
  if (!expect(what)) return 0;
  const Token& token = command_->arguments[next_];
  std::vector<std::string_view> matches;
  std::size_t found = 0;
  for (std::size_t i = 0; i < keywords.size(); ++i) {
    if (keywords[i] == token.text) {
      ++next_;
      return i;
    }
    if (!keywords[i].starts_with(token.text)) continue;
    matches.push_back(keywords[i]);
    found = i;
  }
  if (matches.size() == 1) {
    ++next_;
    return found;
  }
  if (matches.empty()) {
    fail(locate(*file_, token), "unknown " + text_of(what) + " " + in_quotes(token.text) +
                                    ", expected " + list_of(keywords) +
                                    did_you_mean(token.text, {keywords.begin(), keywords.end()}));
  } else {
    fail(locate(*file_, token), "ambiguous " + text_of(what) + " " + in_quotes(token.text) +
                                    ", expected one of " + list_of(matches));
  }
  return 0;
}

bool Arguments::take_if(std::string_view keyword, std::size_t least) {
  const std::string_view text = peek();
  if (text.size() < least || !keyword.starts_with(text)) return false;
  ++next_;
  return true;
}

}  // namespace cs2mesh
