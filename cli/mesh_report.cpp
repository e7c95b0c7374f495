#include "cli/mesh_report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace cs2mesh {
namespace {

/// The parts as if they were one mesh.
MeshReport combined(const std::vector<PartReport>& parts) {
  MeshReport all;
  all.closed = all.manifold_edges = all.manifold_vertices = all.oriented = all.outward = true;
  all.self_intersections = 0;
  for (const auto& [name, part] : parts) {
    all.vertices += part.vertices;
    all.triangles += part.triangles;
    all.components += part.components;
    all.voids += part.voids;
    all.genus += part.genus;
    all.closed &= part.closed;
    all.manifold_edges &= part.manifold_edges;
    all.manifold_vertices &= part.manifold_vertices;
    all.oriented &= part.oriented;
    all.outward &= part.outward;
    all.area += part.area;
    all.volume += part.volume;
    all.shapes.min_angle_deg = std::min(all.shapes.min_angle_deg, part.shapes.min_angle_deg);
    all.shapes.thin += part.shapes.thin;
    if (part.self_intersections && all.self_intersections) {
      *all.self_intersections += *part.self_intersections;
    } else {
      all.self_intersections.reset();
    }
  }
  return all;
}

void add_measures(Json& json, const MeshReport& report) {
  json["vertices"] = report.vertices;
  json["triangles"] = report.triangles;
  json["components"] = report.components;
  json["voids"] = report.voids;
  json["genus"] = report.genus;
  json["closed"] = report.closed;
  json["manifold"] = report.manifold_edges && report.manifold_vertices;
  json["oriented"] = report.oriented && report.outward;
  json["self_intersections"] =
      report.self_intersections ? Json(*report.self_intersections) : Json(nullptr);
  json["area"] = report.area;
  json["volume"] = report.volume;
  json["min_angle_deg"] = report.shapes.min_angle_deg;
  const double count = static_cast<double>(std::max<std::size_t>(report.triangles, 1));
  json["below_20_deg"] = static_cast<double>(report.shapes.thin) / count;
}

Diagnostic warning_at(const std::string& file, const std::string& message) {
  Diagnostic warning = error_at({file, 0, 0}, message, Failure::none);
  warning.severity = Severity::warning;
  return warning;
}

std::string text_of(const Vec3d& v) {
  char text[128];
  std::snprintf(text, sizeof text, "(%.9g, %.9g, %.9g)", v.x, v.y, v.z);
  return text;
}

std::string counted(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string void_text(std::size_t voids) {
  return voids == 0 ? "" : " (" + counted(voids, "void") + ")";
}

}  // namespace

Json to_json(const Vec3d& v) {
  return Json::array({v.x, v.y, v.z});
}

Json to_json(const PartReport& part) {
  Json json = {{"name", part.name}};
  add_measures(json, part.report);
  return json;
}

void add_check(Json& report, const std::vector<PartReport>& parts) {
  add_measures(report, combined(parts));
  Json listed = Json::array();
  for (const auto& [name, part] : parts) {
    for (const Defect& defect : part.defects) {
      listed.push_back({{"position", to_json(defect.where)},
                        {"reason", cs2mesh::name(defect.kind)},
                        {"part", name},
                        {"triangles", defect.triangles}});
    }
  }
  report["listed"] = std::move(listed);
}

std::string summary(const std::vector<PartReport>& parts) {
  const MeshReport all = combined(parts);
  std::string text = std::to_string(all.vertices) + " vertices, " + std::to_string(all.triangles) +
                     " triangles, " + counted(parts.size(), "part") + ", " +
                     counted(all.components, "component") + void_text(all.voids) + ", genus " +
                     std::to_string(all.genus);
  text += all.closed ? ", closed" : ", not closed";
  text += all.manifold_edges && all.manifold_vertices ? ", manifold" : ", not manifold";
  text += ", self-intersections: ";
  text += all.self_intersections ? std::to_string(*all.self_intersections) : "not checked";
  return text;
}

std::vector<Diagnostic> defect_messages(const std::vector<PartReport>& parts,
                                        const std::string& file) {
  std::vector<Diagnostic> messages;
  for (const auto& [name, part] : parts) {
    for (std::size_t kind = 0; kind < kDefectKinds; ++kind) {
      if (part.counts[kind] == 0) continue;
      const auto is_kind = [kind](const Defect& defect) {
        return static_cast<std::size_t>(defect.kind) == kind;
      };
      const std::string_view words = cs2mesh::name(static_cast<DefectKind>(kind));
      std::string text = "part '" + name + "': " + counted(part.counts[kind], std::string(words));
      const auto first = std::find_if(part.defects.begin(), part.defects.end(), is_kind);
      if (first != part.defects.end()) text += ", the first at " + text_of(first->where);
      messages.push_back(error_at({file, 0, 0}, text, Failure::check_failed));
    }
  }
  return messages;
}

void warn_if_unchecked(const std::vector<PartReport>& parts, const std::string& file,
                       Console& console) {
  if (combined(parts).self_intersections) return;
  console.show(std::vector<Diagnostic>(
      1, warning_at(file, "self-intersections could not be looked for (no CGAL in this build?)")));
}

}  // namespace cs2mesh
