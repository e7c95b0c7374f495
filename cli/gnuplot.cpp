#include "cli/gnuplot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cli/child_process.h"
#include "cli/printed.h"
#include "polygonize/mesh_output.h"

namespace cs2mesh {
namespace {

/// Colours that are told apart by colour-blind eyes too (Okabe and Ito 2008), then again.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#000000"};
constexpr double kFloorDecades = 4;  // below the points, that are worth the room

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double decades() const { return std::log10(high / low); }
};

bool plottable(double value) {
  return std::isfinite(value) && value > 0;
}

std::string number(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

/// In single quotes gnuplot reads nothing but the quote itself.
std::string quoted(const std::string& words) {
  std::string text = "'";
  for (const char c : printable_name(words)) {
    text += c;
    if (c == '\'') text += c;
  }
  return text + "'";
}

/// Ticks at so many places of every decade that there are a few.
std::string ticks(const Range& range) {
  std::vector<double> steps = {1};
  if (range.decades() < 2.5) steps = {1, 2, 5};
  if (range.decades() < 0.9) steps = {1, 1.5, 2, 3, 4, 6, 8};
  const int first = static_cast<int>(std::floor(std::log10(range.low)));
  const int last = static_cast<int>(std::ceil(std::log10(range.high)));
  std::string list;
  for (int decade = first; decade <= last; ++decade) {
    for (const double step : steps) {
      const double at = step * std::pow(10.0, decade);
      if (at < range.low || at > range.high) continue;
      list += (list.empty() ? "" : ", ") + quoted(printed("%.7g", at)) + " " + number(at);
    }
  }
  return "(" + list + ")";
}

/// The points that have a place.
std::vector<PlotPoint> placed(const PlotLine& line) {
  std::vector<PlotPoint> points;
  for (const PlotPoint& point : line.points) {
    if (plottable(point.x) && plottable(point.y)) points.push_back(point);
  }
  return points;
}

std::string data_block(const std::string& name, const std::vector<PlotPoint>& points) {
  std::string text = "$" + name + " << END_OF_DATA\n";
  for (const PlotPoint& point : points) {
    const double high = plottable(point.y_high) ? std::max(point.y, point.y_high) : point.y;
    text += number(point.x) + " " + number(point.y) + " " + number(high) + "\n";
  }
  return text + "END_OF_DATA\n";
}

std::string block_name(std::size_t line) {
  return "line" + std::to_string(line);
}

/// A line of the plot with its tint, for `plot`; a comma before each.
std::string curves_of(std::size_t line, const std::string& title) {
  const std::string block = ", $" + block_name(line);
  const std::string color = quoted(kColors[line % kColors.size()]);
  return block + " using 1:2:3 with filledcurves fillcolor rgb " + color +
         " fillstyle transparent solid 0.25 noborder notitle" + block +
         " using 1:2 with linespoints linewidth 2 pointtype 7 pointsize 0.6 linecolor rgb " +
         color + " title " + quoted(title);
}

std::string axes(const LogLogPlot& plot, const Range& x, const Range& y) {
  std::string text = "set terminal svg noenhanced font 'sans-serif,13' background '#ffffff' size " +
                     std::to_string(plot.width) + "," + std::to_string(plot.height) + "\n";
  text += "set logscale xy\nset grid linecolor rgb '#dddddd'\nset border linecolor rgb '#666666'\n";
  text += "set key below\n";
  text += "set xlabel " + quoted(plot.x_label) + "\nset ylabel " + quoted(plot.y_label) + "\n";
  text += "set xrange [" + number(x.low) + ":" + number(x.high) + "]\n";
  text += "set yrange [" + number(y.low) + ":" + number(y.high) + "]\n";
  text += "set xtics " + ticks(x) + "\nset ytics " + ticks(y) + "\n";
  if (plot.floor > y.low) {
    text += "set object 1 rectangle from graph 0, graph 0 to graph 1, first " + number(plot.floor) +
            " fillcolor rgb '#d8d8d8' fillstyle solid noborder behind\n";
  }
  return text;
}

}  // namespace

std::string gnuplot_script(const LogLogPlot& plot) {
  Range x, y;
  std::string blocks, curves;
  std::vector<PlotPoint> front;
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    const std::vector<PlotPoint> points = placed(plot.lines[i]);
    if (points.empty()) continue;
    for (const PlotPoint& point : points) {
      x.include(point.x);
      y.include(point.y);
      if (plottable(point.y_high)) y.include(point.y_high);
      if (point.front) front.push_back(point);
    }
    blocks += data_block(block_name(i), points);
    curves += curves_of(i, plot.lines[i].title);
  }
  if (blocks.empty()) return "";

  std::stable_sort(front.begin(), front.end(),
                   [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  blocks += data_block("front", front);
  curves += ", $front using 1:2 with steps dashtype 3 linecolor rgb '#555555' notitle";
  curves +=
      ", $front using 1:2 with points pointtype 6 pointsize 1.5 linewidth 2"
      " linecolor rgb '#222222' title 'Pareto front'";
  if (plottable(plot.floor)) {
    curves += ", NaN with filledcurves x1 fillcolor rgb '#d8d8d8' fillstyle solid noborder title " +
              quoted(plot.floor_title + (plot.floor * std::pow(10.0, kFloorDecades) < y.low
                                             ? ": " + printed("%.3g", plot.floor) + ", far below"
                                             : ": " + printed("%.3g", plot.floor)));
    if (plot.floor * std::pow(10.0, kFloorDecades) >= y.low) y.include(plot.floor / 2);
  }
  // Room around the points.
  const Range x_wide{x.low / 1.5, x.high * 1.5}, y_wide{y.low / 1.5, y.high * 1.5};
  return axes(plot, x_wide, y_wide) + blocks + "plot " + curves.substr(2) + "\n";
}

Result<std::string> draw_with_gnuplot(const LogLogPlot& plot) {
  const std::string script = gnuplot_script(plot);
  if (script.empty()) return error_at({}, "there is nothing to plot");
  // Without the user's own settings; the script comes on the standard input.
  return run_child({"gnuplot", "--default-settings", "-"}, script);
}

}  // namespace cs2mesh
