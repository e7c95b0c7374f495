#include "cli/report_rows.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/mesh_parts.h"
#include "cli/printed.h"

namespace cs2mesh {
namespace {

constexpr std::array<RunColumn, 22> kColumns = {{
    {"mesher", "mesher", "/mesher", ColumnKind::text},
    {"tolerance", "tolerance", "/tolerance", ColumnKind::length},
    {"tolerance_share", "of the diagonal", "/tolerance_share", ColumnKind::share},
    {"outcome", "outcome", "/outcome", ColumnKind::text},
    {"seconds", "seconds", "/seconds/mesh", ColumnKind::seconds},
    {"cpu_seconds", "CPU seconds", "/seconds/cpu", ColumnKind::seconds},
    {"triangles", "triangles", "/triangles", ColumnKind::count},
    {"max", "largest distance", "/error/max", ColumnKind::length},
    {"spread", "± by sampling", "/error/spread", ColumnKind::length},
    {"mesh_to_surface_max", "mesh to surface", "/error/mesh_to_surface_max", ColumnKind::length},
    {"surface_to_mesh_max", "surface to mesh", "/error/surface_to_mesh_max", ColumnKind::length},
    {"rms", "RMS", "/error/rms", ColumnKind::length},
    {"p999", "99.9 % within", "/error/p999", ColumnKind::length},
    {"normal_deg_max", "normals within, degrees", "/error/normal_deg_max", ColumnKind::degrees},
    {"normal_deg_mean", "mean, degrees", "/error/normal_deg_mean", ColumnKind::degrees},
    {"value_evaluations", "values", "/evaluations/value", ColumnKind::count},
    {"gradient_evaluations", "gradients", "/evaluations/gradient", ColumnKind::count},
    {"enclosures", "bounds", "/evaluations/enclosure", ColumnKind::count},
    {"peak_memory_bytes", "peak memory, MB", "/peak_memory_bytes", ColumnKind::megabytes},
    {"pareto_seconds", "front: time", "/pareto/seconds", ColumnKind::flag},
    {"pareto_triangles", "front: triangles", "/pareto/triangles", ColumnKind::flag},
    {"remark", "remark", "/remark", ColumnKind::text},
}};

/// null where there is no mesh to be counted.
Json of_mesh(const LadderRun& run, std::size_t count) {
  return run.has_mesh() ? Json(count) : Json(nullptr);
}

/// The same of the evaluations, each of them.
Json evaluations_of(const LadderRun& run) {
  Json counts = to_json(run.evaluations);
  for (Json& count : counts) count = of_mesh(run, count);
  return counts;
}

Json error_to_json(const LadderRun& run) {
  if (!run.has_mesh()) return nullptr;
  Json error = {{"max", run.error.max()}, {"spread", run.spread}};
  error.update(to_json(run.error));
  error["normal_deg_mean"] = run.error.normal_deg_mean;
  error["estimate"] = run.estimate;
  return error;
}

Json fit_to_json(const std::optional<PowerFit>& fit) {
  if (!fit) return nullptr;
  return {{"exponent", fit->exponent}, {"deviation", fit->deviation}, {"points", fit->points}};
}

std::string csv_field(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_number_float() && !std::isfinite(value.get<double>())) return "inf";
  if (!value.is_string()) return value.dump();
  const std::string& words = value.get_ref<const std::string&>();
  if (words.find_first_of(",\"\r\n") == std::string::npos) return words;
  std::string field = "\"";
  for (const char c : words) {
    field += c;
    if (c == '"') field += c;
  }
  return field + "\"";
}

}  // namespace

Json runs_to_json(std::span<const LadderRun> runs, double diagonal) {
  const std::vector<bool> by_seconds = pareto_runs(runs, RunCost::seconds);
  const std::vector<bool> by_triangles = pareto_runs(runs, RunCost::triangles);
  Json rows = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const LadderRun& run = runs[i];
    rows.push_back(
        {{"mesher", run.mesher},
         {"tolerance", run.tolerance},
         {"tolerance_share", run.tolerance / diagonal},
         {"outcome", name(run.outcome)},
         {"remark", run.remark},
         {"vertices", of_mesh(run, run.vertices)},
         {"triangles", of_mesh(run, run.triangles)},
         {"error", error_to_json(run)},
         {"evaluations", evaluations_of(run)},
         {"seconds",
          {{"mesh", run.seconds}, {"cpu", run.cpu_seconds}, {"measure", run.measure_seconds}}},
         {"timings", run.timings},
         {"peak_memory_bytes", run.peak_memory},
         {"pareto",
          {{"seconds", static_cast<bool>(by_seconds[i])},
           {"triangles", static_cast<bool>(by_triangles[i])}}}});
  }
  return rows;
}

Json orders_to_json(std::span<const MesherOrders> orders) {
  Json rows = Json::array();
  for (const MesherOrders& entry : orders) {
    rows.push_back({{"mesher", entry.mesher},
                    {"max_by_triangles", fit_to_json(entry.max_by_triangles)},
                    {"rms_by_triangles", fit_to_json(entry.rms_by_triangles)},
                    {"max_by_seconds", fit_to_json(entry.max_by_seconds)}});
  }
  return rows;
}

std::span<const RunColumn> run_columns() {
  return kColumns;
}

Json value_in(const Json& run, const RunColumn& column) {
  const Json::json_pointer pointer{std::string(column.pointer)};
  return run.contains(pointer) ? run.at(pointer) : Json(nullptr);
}

std::string shown(const Json& value, ColumnKind kind) {
  if (value.is_null()) return "";
  if (kind == ColumnKind::text) return value.get<std::string>();
  if (kind == ColumnKind::flag) return value.get<bool>() ? "yes" : "";
  const double number = value.get<double>();
  if (!std::isfinite(number)) return "infinite";
  switch (kind) {
    case ColumnKind::count:
      return printed("%.0f", number);
    case ColumnKind::share:
      return printed("%.3g %%", 100 * number);
    case ColumnKind::megabytes:
      return printed("%.1f", number / 1e6);
    default:
      return printed("%.3g", number);
  }
}

std::string to_csv(const Json& runs) {
  std::string text;
  for (const RunColumn& column : kColumns) {
    text += (text.empty() ? "" : ",") + std::string(column.name);
  }
  text += "\r\n";
  for (const Json& run : runs) {
    for (const RunColumn& column : kColumns) {
      text += (&column == kColumns.data() ? "" : ",") + csv_field(value_in(run, column));
    }
    text += "\r\n";
  }
  return text;
}

}  // namespace cs2mesh
