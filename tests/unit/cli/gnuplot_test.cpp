#include "cli/gnuplot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cs2mesh {
namespace {

LogLogPlot plot() {
  LogLogPlot plot;
  plot.x_label = "triangles";
  plot.y_label = "error";
  plot.lines = {{"it's `id` \"$HOME\"\nset output 'x'",
                 {{200, 1e-3, 2e-3, true}, {100, 1e-2, 1e-2, true}, {300, 5e-3, 5e-3, false}}}};
  plot.floor = 1e-6;
  plot.floor_title = "floor";
  return plot;
}

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(Gnuplot, WordsStayWithinTheirQuotes) {
  const std::string script = gnuplot_script(plot());
  EXPECT_TRUE(holds(script, "'it''s `id` \"$HOME\"_set output ''x'''"));
  EXPECT_FALSE(holds(script, "\nset output"));
}

TEST(Gnuplot, PointsInTheirOrderAndOnlyThoseWithAPlace) {
  LogLogPlot some = plot();
  some.lines[0].points.push_back({400, std::numeric_limits<double>::infinity(), 1, false});
  some.lines[0].points.push_back({0, 1e-3, 1e-3, false});
  some.lines[0].points.push_back({500, std::nan(""), 1e-3, false});
  const std::string script = gnuplot_script(some);
  EXPECT_TRUE(holds(script,
                    "$line0 << END_OF_DATA\n200 0.001 0.002\n100 0.01 0.01\n300 0.005 0.005\n"
                    "END_OF_DATA\n"));
  EXPECT_TRUE(holds(script,
                    "$front << END_OF_DATA\n100 0.01 0.01\n200 0.001 0.002\n"
                    "END_OF_DATA\n"));
}

TEST(Gnuplot, TheFloorIsABandWhereItIsNear) {
  LogLogPlot some = plot();
  EXPECT_TRUE(holds(gnuplot_script(some), "rectangle"));
  EXPECT_TRUE(holds(gnuplot_script(some), "'floor: 1e-06'"));
  some.floor = 1e-12;
  EXPECT_FALSE(holds(gnuplot_script(some), "rectangle"));
  EXPECT_TRUE(holds(gnuplot_script(some), "'floor: 1e-12, far below'"));
  some.floor = 0;
  EXPECT_FALSE(holds(gnuplot_script(some), "floor"));
}

TEST(Gnuplot, NothingToPlot) {
  LogLogPlot some = plot();
  for (PlotPoint& point : some.lines[0].points) point.y = 0;
  EXPECT_EQ(gnuplot_script(some), "");
  EXPECT_FALSE(draw_with_gnuplot(some));
}

}  // namespace
}  // namespace cs2mesh
