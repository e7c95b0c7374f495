#include "cli/report_request.h"

#include <CLI/CLI.hpp>

#include "cli/output_files.h"

namespace cs2mesh {
namespace {

constexpr std::size_t kMostTolerances = 64;

void take_tolerances(ReportRequest& request, const std::vector<std::string>& words) {
  request.tolerances.clear();
  for (const std::string& word : words) {
    const std::optional<Length> length = parse_length(word);
    if (!length) {
      throw CLI::ValidationError(
          "--tolerances",
          "expected lengths greater than 0 such as 0.01 or 0.1%, found '" + word + "'");
    }
    request.tolerances.push_back(*length);
  }
  if (request.tolerances.size() > kMostTolerances) {
    throw CLI::ValidationError("--tolerances",
                               "more than " + std::to_string(kMostTolerances) + " of them");
  }
}

void add_ladder_options(CLI::App& app, ReportRequest& request) {
  app.add_option_function<std::vector<std::string>>(
         "--tolerances",
         [&request](const std::vector<std::string>& words) { take_tolerances(request, words); },
         "the ladder: scene units, or % of the scene's diagonal (default: 1%,0.5%,0.2%,0.1%)")
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("LIST");
  std::vector<std::string> names;
  for (const Mesher& mesher : meshers()) names.emplace_back(mesher.name);
  app.add_option_function<std::vector<std::string>>(
         "--meshers",
         [&request](const std::vector<std::string>& words) {
           request.meshers.clear();
           for (const std::string& word : words) request.meshers.push_back(find_mesher(word));
         },
         "those to compare (default: all)")
      ->check(CLI::IsMember(names))
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("LIST");
  app.add_option("--time-limit", request.time_limit,
                 "cut a run off that has meshed for S seconds (default: none)")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
}

}  // namespace

std::vector<std::string> ReportRequest::outputs() const {
  std::vector<std::string> paths = {page};
  if (!csv.empty()) paths.push_back(csv);
  return paths;
}

ReportRequest parse_report_request(const Words& arguments) {
  ReportRequest request;
  request.tolerances = {{0.01, true}, {0.005, true}, {0.002, true}, {0.001, true}};
  for (const Mesher& mesher : meshers()) request.meshers.push_back(&mesher);
  CLI::App app(
      "error against run time and triangles: a ladder of tolerances with every mesher, "
      "measured, as one page",
      "cs2mesh report");
  add_bounded_scene_options(app, request.input);
  app.add_option("out", request.page, "the page, a file in .html")->required()->type_name("OUT");
  app.add_option("--csv", request.csv, "also write the table of runs, as .csv")->type_name("FILE");
  add_ladder_options(app, request);
  app.add_option("--samples", request.samples, "points to measure at, each way")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e9))
      ->type_name("N");
  app.add_option("--size", request.size, "width of the pictures, pixels")
      ->capture_default_str()
      ->check(CLI::Range(16, 4096))
      ->type_name("W");
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

void require_writable(const ReportRequest& request, Console& console) {
  console.take(OutputFiles::has_extension(request.page, ".html"));
  if (!request.csv.empty()) console.take(OutputFiles::has_extension(request.csv, ".csv"));
  for (const std::string& path : request.outputs()) console.take(OutputFiles::can_write(path));
}

}  // namespace cs2mesh
