#include "cli/report_rows.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>

#include "cli/report_html.h"

namespace cs2mesh {
namespace {

std::vector<LadderRun> runs() {
  std::vector<LadderRun> runs(3);
  runs[0].mesher = runs[1].mesher = runs[2].mesher = "some";
  runs[0].outcome = RunOutcome::reached;
  runs[0].tolerance = 0.1;
  runs[0].triangles = 1234;
  runs[0].error.mesh_to_surface_max = 1.0 / 12;
  runs[0].peak_memory = 1'500'000;
  runs[1].outcome = RunOutcome::missed;
  runs[1].error.surface_to_mesh_max = std::numeric_limits<double>::infinity();
  runs[1].remark = "a \"quoted\" word, <b>bold</b>";
  runs[2].remark = "no mesh";
  return runs;
}

std::string cell(const Json& run, const std::string& column) {
  for (const RunColumn& known : run_columns()) {
    if (known.name == column) return shown(value_in(run, known), known.kind);
  }
  ADD_FAILURE() << column;
  return "";
}

TEST(ReportRows, JsonOfARun) {
  const Json rows = runs_to_json(runs(), 10);
  EXPECT_EQ(rows[0]["outcome"], "reached");
  EXPECT_EQ(rows[0]["error"]["max"], 1.0 / 12);
  EXPECT_EQ(rows[0]["tolerance_share"], 0.01);
  EXPECT_EQ(rows[0]["pareto"]["triangles"], true);
  EXPECT_EQ(rows[1]["pareto"]["triangles"], false);
  EXPECT_TRUE(rows[2]["error"].is_null());
  EXPECT_TRUE(rows[2]["triangles"].is_null());
}

TEST(ReportRows, CellsForPeople) {
  const Json rows = runs_to_json(runs(), 10);
  EXPECT_EQ(cell(rows[0], "max"), "0.0833");
  EXPECT_EQ(cell(rows[0], "tolerance_share"), "1 %");
  EXPECT_EQ(cell(rows[0], "triangles"), "1234");
  EXPECT_EQ(cell(rows[0], "peak_memory_bytes"), "1.5");
  EXPECT_EQ(cell(rows[0], "pareto_triangles"), "yes");
  EXPECT_EQ(cell(rows[1], "max"), "infinite");
  EXPECT_EQ(cell(rows[2], "max"), "");
}

TEST(ReportRows, CsvQuotesWhatNeedsIt) {
  const std::string csv = to_csv(runs_to_json(runs(), 10));
  EXPECT_EQ(csv.substr(0, 17), "mesher,tolerance,");
  EXPECT_NE(csv.find(",0.08333333333333333,"), std::string::npos);
  EXPECT_NE(csv.find(",inf,"), std::string::npos);
  EXPECT_NE(csv.find(",\"a \"\"quoted\"\" word, <b>bold</b>\"\r\n"), std::string::npos);
}

TEST(ReportHtml, AllWordsAreEscaped) {
  const std::vector<LadderRun> some = runs();
  Json report = {{"input", "<script>alert(1)</script>\"'&.art"}, {"primitives", 1}};
  report.update({{"parts", 1}, {"diagonal", 10.0}, {"samples", 100}, {"time_limit", nullptr}});
  report.update({{"reference", {{"uncertainty", 1e-9}}}, {"threads", 2}, {"memory", "run"}});
  report.update({{"version", "0"}, {"runs", runs_to_json(some, 10)}});
  report["orders"] = orders_to_json(fit_orders(some));
  ReportPage page;
  page.no_plots = "<i>gnuplot</i>";
  page.reference = {"image/png", "bytes", "<u>caption\" onload=\"alert(1)</u>"};
  const std::string html = report_html(report, page);
  for (const char* markup : {"<script", "<b>bold", "<i>", "<u>", "\" onload"}) {
    EXPECT_EQ(html.find(markup), std::string::npos) << markup;
  }
  EXPECT_NE(html.find("data-column=\"max\" class=\"number\" data-value=\"0.08333333333333333\""),
            std::string::npos);
  EXPECT_NE(html.find("infinite"), std::string::npos);
}

}  // namespace
}  // namespace cs2mesh
