#include "cli/report_pictures.h"

#include <algorithm>
#include <cmath>

#include "cli/gnuplot.h"
#include "cli/printed.h"
#include "libfield/ray/png.h"
#include "libfield/ray/render.h"
#include "polygonize/attributes.h"
#include "polygonize/error_picture.h"
#include "polygonize/render_mesh.h"

namespace cs2mesh {
namespace {

/// Rays a pixel, along each side.
constexpr int kSamples = 2;

int height_for(const Camera& camera, int width) {
  const double height = static_cast<double>(width) * camera.height / std::max(camera.width, 1);
  return static_cast<int>(std::clamp<long>(std::lround(height), 1, kMostPixels / width));
}

std::string words_for(const LadderRun& run) {
  return run.mesher + ", tolerance " + printed("%.3g", run.tolerance);
}

/// " (order -1.02)", or nothing.
std::string order_text(const std::optional<PowerFit>& fit) {
  return fit ? " (order " + printed("%.2f", fit->exponent) + ")" : "";
}

LogLogPlot plot_of(std::span<const LadderRun> runs, RunCost cost, double uncertainty,
                   double diagonal) {
  const std::vector<bool> front = pareto_runs(runs, cost);
  LogLogPlot plot;
  plot.x_label = cost == RunCost::seconds ? "meshing, seconds" : "triangles";
  plot.y_label = "largest distance, share of the diagonal";
  plot.floor = uncertainty / diagonal;
  plot.floor_title = "uncertainty of the reference";
  for (const MesherOrders& orders : fit_orders(runs)) {
    PlotLine line;
    line.title = orders.mesher + order_text(cost == RunCost::seconds ? orders.max_by_seconds
                                                                     : orders.max_by_triangles);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const LadderRun& run = runs[i];
      if (run.mesher != orders.mesher || !run.has_mesh()) continue;
      const double error = run.error.max();
      line.points.push_back({cost_of(run, cost), error / diagonal,
                             (error + run.spread + uncertainty) / diagonal, front[i]});
    }
    plot.lines.push_back(std::move(line));
  }
  return plot;
}

}  // namespace

ReportPictures::ReportPictures(const Scene& scene, const CompiledScene& compiled, int width,
                               std::span<const double> tolerances, Console& console)
    : scene_(scene),
      compiled_(compiled),
      console_(console),
      width_(width),
      height_(height_for(scene.camera, width)),
      low_(*std::min_element(tolerances.begin(), tolerances.end()) / 100),
      high_(*std::max_element(tolerances.begin(), tolerances.end())),
      view_(make_view(scene.camera, compiled.extent, width_, height_)) {}

ReportFigure ReportPictures::png(const ColorImage& image, const std::string& caption) const {
  console_.stop_if_interrupted();
  return {"image/png", console_.take(encode_png(image)), caption};
}

void ReportPictures::start(ReportPage& page) {
  RenderOptions options;
  options.width = width_;
  options.height = height_;
  options.samples = kSamples;
  options.view = view_;
  options.depth = true;
  options.progress = &console_.progress();
  RenderedImage image = console_.take(render(compiled_, scene_, options));
  page.reference = png(image.color, "The exact surface, ray-traced without a mesh");
  depth_ = std::move(image.depth);
  constexpr int kScaleWidth = 256;
  page.color_scale = png(false_color_scale(kScaleWidth), "distance to the surface, logarithmic");
  page.scale_low = low_;
  page.scale_high = high_;
}

void ReportPictures::add(const LadderRun& run, Model& model, ReportPage& page) const {
  if (!run.has_mesh()) return;
  ScalarImage errors =
      error_picture(model, compiled_, view_, width_, height_, &console_.progress());
  mark_missing_mesh(depth_, errors);
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    add_colors(model.parts[i].mesh, *compiled_.parts[i].materials, scene_.materials);
  }
  RenderMeshOptions options;
  options.width = width_;
  options.height = height_;
  options.samples = kSamples;
  options.progress = &console_.progress();
  page.pairs.push_back(
      {png(render_mesh(model, scene_, view_, options),
           words_for(run) + ": " + std::to_string(run.triangles) + " triangles"),
       png(false_colors(errors, low_, high_),
           words_for(run) + ": off by at most " + printed("%.3g", run.error.max()))});
}

void add_plots(std::span<const LadderRun> runs, double uncertainty, double diagonal,
               ReportPage& page, Console& console) {
  for (const RunCost cost : {RunCost::seconds, RunCost::triangles}) {
    const LogLogPlot plot = plot_of(runs, cost, uncertainty, diagonal);
    Result<std::string> drawn = draw_with_gnuplot(plot);
    console.stop_if_interrupted();
    if (!drawn) {
      page.plots.clear();
      page.no_plots = drawn.diagnostics().front().message;
      Diagnostic warning = error_at({}, "no plots: " + page.no_plots, Failure::none);
      warning.severity = Severity::warning;
      console.show(std::vector<Diagnostic>(1, warning));
      return;
    }
    page.plots.push_back({"image/svg+xml", *std::move(drawn),
                          "Largest distance against " +
                              std::string(cost == RunCost::seconds ? "run time" : "triangles")});
  }
}

}  // namespace cs2mesh
