// Plots on logarithmic axes, drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "libfield/base/result.h"

namespace cs2mesh {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
  double y_high = 0.0;  ///< y may be as large as this
  bool front = false;   ///< marked, as on the Pareto front
};

struct PlotLine {
  std::string title;
  std::vector<PlotPoint> points;  ///< joined in this order
};

/// y over x, both logarithmic. Points of which a coordinate is not finite or not > 0 are left out.
struct LogLogPlot {
  std::string x_label, y_label;
  std::vector<PlotLine> lines;
  /// y below this mean nothing: a band, where that is within four decades of the points, and in any
  /// case a line of the legend. 0 for none.
  double floor = 0.0;
  std::string floor_title;
  int width = 640, height = 480;  ///< pixels
};

/// What gnuplot is told; empty where no point is left. Words of the plot are quoted, whatever they
/// hold.
std::string gnuplot_script(const LogLogPlot& plot);

/// The plot as SVG, by the program `gnuplot` in PATH. Errors: those of run_child(); nothing to plot
/// (Failure::bad_input).
Result<std::string> draw_with_gnuplot(const LogLogPlot& plot);

}  // namespace cs2mesh
