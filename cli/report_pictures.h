// The pictures of `cs2mesh report`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/report_html.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/image.h"
#include "polygonize/convergence.h"

namespace cs2mesh {

/// Draws a scene and its meshes in one camera, errors on one scale. Its methods throw Exit after a
/// limit is passed, or after Ctrl-C.
class ReportPictures {
 public:
  /// `width` in pixels; the height is as the scene's frame has it. The colours of errors go from a
  /// hundredth of the smallest to the largest of `tolerances`. Refers to all arguments.
  ReportPictures(const Scene& scene, const CompiledScene& compiled, int width,
                 std::span<const double> tolerances, Console& console);

  /// Traces the reference and sets the scale.
  void start(ReportPage& page);
  /// Adds the pictures of a run; nothing where it has no mesh. Gives the model its colours.
  void add(const LadderRun& run, Model& model, ReportPage& page) const;

 private:
  ReportFigure png(const ColorImage& image, const std::string& caption) const;

  const Scene& scene_;
  const CompiledScene& compiled_;
  Console& console_;
  int width_, height_;
  double low_, high_;
  View view_;
  ScalarImage depth_;
};

/// Largest distance against time and against triangles, for the page. Where they cannot be drawn
/// there is a warning, and page.no_plots says why.
void add_plots(std::span<const LadderRun> runs, double uncertainty, double diagonal,
               ReportPage& page, Console& console);

}  // namespace cs2mesh
