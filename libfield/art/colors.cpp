#include "libfield/art/colors.h"

#include <algorithm>
#include <cctype>
#include <iterator>

namespace cs2mesh {
namespace {

struct NamedColor {
  std::string_view name;
  Color color;
};

constexpr NamedColor kColors[] = {
#include "libfield/art/x11_colors_table.inc"
};

constexpr char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool less_ignoring_case(std::string_view a, std::string_view b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](char x, char y) { return lower(x) < lower(y); });
}

/// Whether `word` is `name` but for the case of the letters that begin a word, which the table
/// writes as capitals.
bool matches(std::string_view word, std::string_view name) {
  return std::equal(word.begin(), word.end(), name.begin(), name.end(),
                    [](char w, char n) { return w == n || w == lower(n); });
}

}  // namespace

std::optional<Color> color_of(std::string_view name) {
  const auto* const found = std::lower_bound(std::begin(kColors), std::end(kColors), name,
                                             [](const NamedColor& entry, std::string_view n) {
                                               return less_ignoring_case(entry.name, n);
                                             });
  if (found == std::end(kColors) || !matches(name, found->name)) return std::nullopt;
  return found->color;
}

const std::vector<std::string_view>& color_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const NamedColor& entry : kColors) all.push_back(entry.name);
    return all;
  }();
  return names;
}

}  // namespace cs2mesh
