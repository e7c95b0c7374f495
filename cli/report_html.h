// The report as one page of HTML that needs nothing else: no script, no link, pictures inside.
#pragma once

#include <string>
#include <vector>

#include "cli/json_report.h"

namespace cs2mesh {

/// A picture with what is to be said of it.
struct ReportFigure {
  std::string media_type;  ///< "image/png", "image/svg+xml"
  std::string bytes;
  std::string caption;
};

/// The pictures of one run.
struct ReportPair {
  ReportFigure mesh, error;
};

struct ReportPage {
  std::vector<ReportFigure> plots;
  std::string no_plots;  ///< why there are none, if there are none
  ReportFigure reference;
  std::vector<ReportPair> pairs;
  ReportFigure color_scale;                  ///< of the errors
  double scale_low = 0.0, scale_high = 0.0;  ///< scene units, at its ends
};

/// The page of what `report` (the JSON of `cs2mesh report`) says. All words are escaped. Cells of
/// the table of runs have the attributes data-column, the column's name, and, where there is a
/// number, data-value, with all its digits as in JSON.
std::string report_html(const Json& report, const ReportPage& page);

}  // namespace cs2mesh
