#include "cli/report_html.h"

#include <nlohmann/json.hpp>

#include "cli/html_text.h"
#include "cli/printed.h"
#include "cli/report_rows.h"

namespace cs2mesh {
namespace {

/// Nothing may be loaded from elsewhere, not even by mistake.
constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.5 sans-serif; color: #222; background: #fff; margin: 2em auto; padding: 0 1.5em;
  max-width: 1360px; }
h1 { font-size: 1.6em; } h2 { font-size: 1.25em; margin-top: 2em; }
table { border-collapse: collapse; margin: 1em 0; }
.wide { overflow-x: auto; }
th, td { padding: 0.25em 0.7em; border-bottom: 1px solid #ddd; text-align: left;
  vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.runs { font-size: 0.78em; } .runs td, .runs th { padding: 0.25em 0.45em; }
tr.off td { background: #fdf0e8; }
figure { margin: 0; } figcaption { font-size: 0.85em; color: #555; }
img { max-width: 100%; height: auto; }
.row { display: flex; flex-wrap: wrap; gap: 1.5em; margin: 1em 0; }
.scale img { width: 480px; height: 18px; }
.scale div { display: flex; justify-content: space-between; width: 480px; font-size: 0.85em; }
.nothing, .missing { display: inline-block; width: 1em; height: 1em; vertical-align: middle; }
.nothing { background: #e8e8e8; } .missing { background: #ff00c8; }
</style>
)";

constexpr std::string_view kReading = R"(<h2>How to read this</h2>
<ul>
<li>Lengths are in scene units unless marked as shares of the diagonal, which is that of the box of
all primitives.</li>
<li>The largest distance is the larger of both ways, mesh to surface and surface to mesh; RMS and
99.9 % are over the samples of both ways. The surface is that of the field itself, no finer mesh.
Between samples a mesh may be farther off: "± by sampling" is how much the largest distance changes
with another seed and half of the samples, drawn as the tint above each line.</li>
<li>The uncertainty of the reference is how far the points that count as surface are off it by
themselves: the Newton step that is left, what the error budget of the field can shift them by, and
the rounding of coordinates. Distances below it mean nothing.</li>
<li>Time is that of meshing alone, on the wall clock; the shortest of up to three where a run is
short. Each starts from a scene compiled anew. CPU seconds are those of all threads together. Memory
is what the process had resident at most.</li>
<li>Orders are exponents p of least squares of log error over log cost, error = c cost^p, with their
standard deviation; none where the costs of the runs are too alike to tell (a factor of 1.5). A
distance of second order in the size of a triangle is p = -1 against
triangles.</li>
<li>A run is on the Pareto front where no other has both a smaller error and a smaller cost.</li>
</ul>
)";

std::string tag(const std::string& name, const std::string& words) {
  return "<" + name + ">" + escape_html(words) + "</" + name + ">";
}

std::string figure(const ReportFigure& picture) {
  return "<figure><img src=\"" + data_uri(picture.media_type, picture.bytes) + "\" alt=\"" +
         escape_html(picture.caption) + "\"><figcaption>" + escape_html(picture.caption) +
         "</figcaption></figure>\n";
}

std::string facts(const Json& report) {
  const auto number = [&](const char* pointer, const char* format) {
    return printed(format, report.at(Json::json_pointer(pointer)).get<double>());
  };
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"Scene", report["input"].get<std::string>()},
      {"Primitives", number("/primitives", "%.0f")},
      {"Parts", number("/parts", "%.0f")},
      {"Diagonal", number("/diagonal", "%.6g")},
      {"Samples each way", number("/samples", "%.0f")},
      {"Uncertainty of the reference", number("/reference/uncertainty", "%.3g")},
      {"Time limit of a run",
       report["time_limit"].is_null() ? "none" : number("/time_limit", "%g s")},
      {"Threads", number("/threads", "%.0f")},
      {"Peak memory", report["memory"] == "run"
                          ? "of each run (the kernel's mark is set back before it)"
                          : "of the process so far (the system does not let its mark be set back)"},
      {"Version", report["version"].get<std::string>()}};
  std::string text = "<table class=\"facts\">\n";
  for (const auto& [name, value] : rows)
    text += "<tr>" + tag("th", name) + tag("td", value) + "</tr>\n";
  return text + "</table>\n";
}

std::string plots(const ReportPage& page) {
  std::string text = "<h2>Error against cost</h2>\n";
  if (page.plots.empty()) return text + tag("p", "There are no plots: " + page.no_plots) + "\n";
  text += "<div class=\"row plots\">\n";
  for (const ReportFigure& plot : page.plots) text += figure(plot);
  return text + "</div>\n";
}

std::string fit_cell(const Json& fit) {
  if (fit.is_null()) return "<td>none</td>";
  return "<td class=\"number\" data-value=\"" + fit["exponent"].dump() + "\">" +
         printed("%.2f", fit["exponent"].get<double>()) + " ± " +
         printed("%.2f", fit["deviation"].get<double>()) + " (" + fit["points"].dump() +
         " runs)</td>";
}

std::string orders(const Json& report) {
  std::string text =
      "<h2>Fitted orders</h2>\n<table class=\"orders\">\n<tr><th>mesher</th>"
      "<th>largest distance against triangles</th><th>RMS against triangles</th>"
      "<th>largest distance against seconds</th></tr>\n";
  for (const Json& row : report["orders"]) {
    text += "<tr>" + tag("td", row["mesher"].get<std::string>()) +
            fit_cell(row["max_by_triangles"]) + fit_cell(row["rms_by_triangles"]) +
            fit_cell(row["max_by_seconds"]) + "</tr>\n";
  }
  return text + "</table>\n";
}

std::string run_cell(const Json& run, const RunColumn& column) {
  const Json value = value_in(run, column);
  std::string text = "<td data-column=\"" + std::string(column.name) + "\"";
  // Infinity is no number of JSON; its cell says so in words.
  if (value.is_number()) text += " class=\"number\" data-value=\"" + value.dump() + "\"";
  return text + ">" + escape_html(shown(value, column.kind)) + "</td>";
}

std::string runs(const Json& report) {
  std::string text = "<h2>Runs</h2>\n<div class=\"wide\"><table class=\"runs\">\n<tr>";
  for (const RunColumn& column : run_columns()) text += tag("th", std::string(column.heading));
  text += "</tr>\n";
  for (const Json& run : report["runs"]) {
    text += run["outcome"] == "reached" ? "<tr>" : "<tr class=\"off\">";
    for (const RunColumn& column : run_columns()) text += run_cell(run, column);
    text += "</tr>\n";
  }
  return text + "</table></div>\n";
}

std::string pictures(const ReportPage& page) {
  std::string text = "<h2>Pictures</h2>\n<div class=\"row reference\">\n" + figure(page.reference) +
                     "</div>\n<div class=\"scale\"><img src=\"" +
                     data_uri(page.color_scale.media_type, page.color_scale.bytes) + "\" alt=\"" +
                     escape_html(page.color_scale.caption) + "\">\n<div><span>≤ " +
                     printed("%.3g", page.scale_low) + "</span>" +
                     tag("span", page.color_scale.caption) + "<span>≥ " +
                     printed("%.3g", page.scale_high) + "</span></div></div>\n" +
                     "<p><span class=\"nothing\"></span> neither mesh nor surface, " +
                     "<span class=\"missing\"></span> surface, but no mesh.</p>\n";
  for (const ReportPair& pair : page.pairs) {
    text += "<div class=\"row pair\">\n" + figure(pair.mesh) + figure(pair.error) + "</div>\n";
  }
  return text;
}

}  // namespace

std::string report_html(const Json& report, const ReportPage& page) {
  const std::string title = "cs2mesh report: " + report["input"].get<std::string>();
  return std::string(kHead) + tag("title", title) + "\n</head>\n<body>\n" + tag("h1", title) +
         "\n" + facts(report) + plots(page) + orders(report) + runs(report) + pictures(page) +
         std::string(kReading) + "</body>\n</html>\n";
}

}  // namespace cs2mesh
