// The runs of a ladder as JSON, and the table that HTML and CSV show of them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "cli/json_report.h"
#include "polygonize/convergence.h"

namespace cs2mesh {

/// One object a run, in order; `error` is null where there is no mesh.
Json runs_to_json(std::span<const LadderRun> runs, double diagonal);

/// [{"mesher": ..., "max_by_triangles": {"exponent": ..., "deviation": ..., "points": ...}, ...}];
/// null where there is no fit.
Json orders_to_json(std::span<const MesherOrders> orders);

/// How a number is shown to people.
enum class ColumnKind { text, count, length, share, seconds, degrees, megabytes, flag };

/// A column of the table of runs.
struct RunColumn {
  std::string_view name;     ///< in CSV
  std::string_view heading;  ///< for people
  std::string_view pointer;  ///< where it stands in a run's JSON (RFC 6901)
  ColumnKind kind = ColumnKind::text;
};
std::span<const RunColumn> run_columns();

/// The value of the column; null where the run has none.
Json value_in(const Json& run, const RunColumn& column);

/// A value for people: numbers with three digits that count, counts in full; "" for null.
std::string shown(const Json& value, ColumnKind kind);

/// A line of names, then one a run; RFC 4180, numbers with all their digits, `inf` for infinite.
std::string to_csv(const Json& runs);

}  // namespace cs2mesh
