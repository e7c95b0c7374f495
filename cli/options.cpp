#include "cli/options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iostream>

#include "cli/exit_status.h"

namespace cs2mesh {
namespace {

std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

void add_define(SceneOptions& options, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw CLI::ValidationError("-D", "expected NAME=VALUE, found '" + text + "'");
  }
  options.defines[text.substr(0, equals)] = text.substr(equals + 1);
}

Aabb box_of(const std::vector<std::string>& words) {
  std::array<double, 6> number{};
  for (std::size_t i = 0; i < number.size(); ++i) {
    const std::optional<double> value = parse_number(words[i]);
    if (!value) throw CLI::ValidationError("--bounds", "'" + words[i] + "' is no number");
    number[i] = *value;
  }
  const Aabb box{{number[0], number[1], number[2]}, {number[3], number[4], number[5]}};
  const Vec3d extent = box.extent();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0)) {
    throw CLI::ValidationError("--bounds",
                               "the box is empty: the first three are its lower corner");
  }
  return box;
}

}  // namespace

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.set_help_flag("-h,--help", "print this text and leave");
  app.add_flag("-q,--quiet", options.quiet, "say nothing but warnings and errors");
  app.add_flag("-v,--verbose", options.verbose, "say the notes on the scene too");
  app.add_option_function<std::string>(
         "--progress",
         [&options](const std::string& word) {
           options.progress = word == "bar"    ? ProgressMode::bar
                              : word == "json" ? ProgressMode::json
                                               : ProgressMode::none;
         },
         "none, bar or json, on stderr (default: bar on a terminal)")
      ->check(CLI::IsMember({"none", "bar", "json"}))
      ->type_name("MODE");
  app.add_option("--threads", options.threads, "threads to use (default: one a core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
}

void add_json_option(CLI::App& app, CommonOptions& options) {
  app.add_flag("--json", options.json, "print one JSON object on stdout");
}

void add_limit_options(CLI::App& app, CommonOptions& options) {
  app.add_option("--time-limit", options.most.seconds,
                 "give up after S seconds, with status 6 (default: none)")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  app.add_option_function<std::string>(
         "--max-memory",
         [&options](const std::string& text) {
           const std::optional<std::uint64_t> bytes = parse_bytes(text);
           if (!bytes) {
             throw CLI::ValidationError(
                 "--max-memory",
                 "expected bytes such as 1000000000, 800M or 1.5G, found '" + text + "'");
           }
           options.most.bytes = *bytes;
         },
         "give up, with status 6, rather than hold more memory than this (default: no limit)")
      ->type_name("BYTES");
}

void add_scene_options(CLI::App& app, SceneOptions& options) {
  app.add_option("scene", options.path, "the scene, a file in .art")
      ->required()
      ->type_name("SCENE");
  app.add_option_function<std::vector<std::string>>(
         "-D",
         [&options](const std::vector<std::string>& words) {
           for (const std::string& word : words) add_define(options, word);
         },
         "set a variable, over the scene's own `var NAME`")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
}

void add_bounded_scene_options(CLI::App& app, SceneOptions& options) {
  add_scene_options(app, options);
  app.add_option_function<std::vector<std::string>>(
         "--bounds",
         [&options](const std::vector<std::string>& words) { options.bounds = box_of(words); },
         "cut the surface off at this box (default: the scene's `mesh bounds`)")
      ->type_name("XMIN YMIN ZMIN XMAX YMAX ZMAX")
      ->expected(6);
}

std::optional<Length> parse_length(const std::string& text) {
  std::string_view number = text;
  const bool relative = number.ends_with('%');
  if (relative) number.remove_suffix(1);
  const std::optional<double> value = parse_number(number);
  if (!value || *value <= 0) return std::nullopt;
  return Length{relative ? *value / 100.0 : *value, relative};
}

std::optional<std::uint64_t> parse_bytes(const std::string& text) {
  constexpr std::string_view kSuffixes = "KMGT";
  std::string_view number = text;
  int power = 0;
  if (!number.empty()) {
    const char last = static_cast<char>(std::toupper(static_cast<unsigned char>(number.back())));
    const std::size_t suffix = kSuffixes.find(last);
    if (suffix != std::string_view::npos) {
      power = 10 * (static_cast<int>(suffix) + 1);
      number.remove_suffix(1);
    }
  }
  const std::optional<double> value = parse_number(number);
  if (!value) return std::nullopt;
  const double bytes = std::ldexp(*value, power);
  if (!(bytes >= 1 && bytes < 0x1p63)) return std::nullopt;
  return static_cast<std::uint64_t>(bytes);
}

CLI::Option* add_length_option(CLI::App& app, const std::string& name, std::optional<Length>& out,
                               const std::string& description) {
  return app
      .add_option_function<std::string>(
          name,
          [&out, name](const std::string& text) {
            out = parse_length(text);
            if (!out) {
              throw CLI::ValidationError(
                  name,
                  "expected a length greater than 0 such as 0.01 or 0.1%, found '" + text + "'");
            }
          },
          description)
      ->type_name("LENGTH");
}

void parse(CLI::App& app, const Words& arguments) {
  try {
    // CLI11 takes the arguments from the back.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    throw Exit{kDone};
  } catch (const CLI::ParseError& error) {
    std::cerr << "cs2mesh: error: " << error.what() << " (see `" << app.get_name() << " --help`)\n";
    throw Exit{kBadInput};
  }
}

}  // namespace cs2mesh
