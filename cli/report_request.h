// The command line of `cs2mesh report`.
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/options.h"
#include "polygonize/mesher.h"

namespace cs2mesh {

struct ReportRequest {
  SceneOptions input;
  CommonOptions common;
  std::string page, csv;
  std::vector<Length> tolerances;  ///< as they were asked for
  std::vector<const Mesher*> meshers;
  std::size_t samples = 200'000;  ///< each way
  int size = 360;                 ///< width of a picture, pixels
  double time_limit = 0.0;        ///< seconds a run; 0: none

  std::vector<std::string> outputs() const;
};

/// Throws Exit where the usage is wrong.
ReportRequest parse_report_request(const Words& arguments);

/// Throws Exit where an output could not be written or has another extension than it should.
void require_writable(const ReportRequest& request, Console& console);

}  // namespace cs2mesh
