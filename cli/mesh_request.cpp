#include "cli/mesh_request.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/output_files.h"
#include "polygonize/unite.h"

namespace cs2mesh {
namespace {

void add_quality_options(CLI::App& app, MeshRequest& request) {
  add_length_option(
      app, "--tolerance", request.tolerance,
      "largest distance between mesh and surface, both ways: scene units, or % of the "
      "scene's diagonal (default: the scene's `mesh tolerance`, or 0.1%)");
  CLI::Option* cell =
      add_length_option(app, "--cell", request.cell,
                        "side of the grid's cells, over what the tolerance suggests (default: the "
                        "scene's `mesh cell`, or chosen)");
  std::vector<std::string> names;
  std::string promises;
  for (const Mesher& mesher : meshers()) {
    names.emplace_back(mesher.name);
    promises += "\n" + names.back() + ": " + std::string(mesher.promise);
  }
  app.add_option(
         "--mesher", request.mesher,
         "how the surface is cut into triangles (default: " + names.front() + ")" + promises)
      ->check(CLI::IsMember(names))
      ->excludes(cell)
      ->type_name("NAME");
  app.add_flag("--balance", request.balance,
               "let the adaptive mesher put vertices off the surface, by less than the tolerance, "
               "outside where it is convex and inside where it is hollow: about half the triangles")
      ->excludes(cell);
  request.united = can_unite();
  app.add_option_function<std::string>(
         "--parts", [&request](const std::string& word) { request.united = word == "united"; },
         "united: parts that touch become one mesh without anything inside; separate: the soft "
         "surface, each blend group and each hard solid are meshes of their own (default: " +
             std::string(can_unite() ? "united" : "separate, since this build has no CGAL") + ")")
      ->check(CLI::IsMember({"united", "separate"}))
      ->type_name("HOW");
  app.add_flag("--verify", request.verify,
               "measure the result with rays before anything is written; status 5 if it is off");
  CLI::Option* certify =
      app.add_flag("--certify", request.certify,
                   "prove that the mesh is within the tolerance and of the surface's topology; "
                   "status 5, and no mesh, where any of it could not be proven");
  CLI::Option* certificate =
      app.add_option("--certificate", request.certificate,
                     "prove it likewise, and write to this PLY file what could not be proven")
          ->type_name("FILE");
  app.add_flag("--no-check{false}", request.self_intersections,
               "leave out the search for self-intersections")
      ->excludes(certify)
      ->excludes(certificate);
}

void add_output_options(CLI::App& app, MeshRequest& request) {
  app.add_option_function<std::vector<std::string>>(
         "--attributes",
         [&request](const std::vector<std::string>& words) {
           request.attributes = words;
           request.all_attributes = false;
         },
         "of normal, color; or none (default: what the format and the scene have)")
      ->check(CLI::IsMember({"normal", "color", "none"}))
      ->delimiter(',')
      ->expected(1, 2)
      ->type_name("LIST");
  app.add_option("--up", request.up,
                 "axis of the scene that points up, which glTF turns to +Y (default: its `vup`)")
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("AXIS");
  app.add_flag("--dry-run", request.dry_run, "say what would be done; write nothing");
  app.add_option("--report", request.report, "write the JSON to this file too")->type_name("FILE");
}

}  // namespace

bool MeshRequest::wants(const std::string& attribute) const {
  return all_attributes ||
         std::find(attributes.begin(), attributes.end(), attribute) != attributes.end();
}

MeshFileOptions MeshRequest::file_options(const Scene& scene) const {
  MeshFileOptions options;
  options.normals = wants("normal");
  options.colors = wants("color");
  options.up = scene.camera.up;
  if (up == "y") options.up = {0, 1, 0};
  if (up == "z" || norm(options.up) == 0) options.up = {0, 0, 1};
  return options;
}

MeshRequest parse_mesh_request(const Words& arguments) {
  MeshRequest request;
  CLI::App app("mesh a scene; the extension picks the format (" +
                   std::string(writable_mesh_extensions()) + ")",
               "cs2mesh");
  add_bounded_scene_options(app, request.input);
  app.add_option("out", request.outputs, "the mesh; several are written from the same run")
      ->required()
      ->type_name("OUT...");
  add_quality_options(app, request);
  add_output_options(app, request);
  add_limit_options(app, request.common);
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

void require_writable(const MeshRequest& request, Console& console) {
  for (const std::string& path : request.outputs) {
    const std::optional<MeshFormat> format = mesh_format_of(path);
    if (!format || *format == MeshFormat::gltf || *format == MeshFormat::off) {
      console.fail(Failure::bad_input,
                   "no format to write by this extension, expected one of " +
                       std::string(writable_mesh_extensions()),
                   {path, 0, 0});
    }
  }
  if (request.dry_run) return;
  for (const std::string& path : request.outputs) console.take(OutputFiles::can_write(path));
  if (!request.report.empty()) console.take(OutputFiles::can_write(request.report));
  if (!request.certificate.empty()) {
    console.take(OutputFiles::has_extension(request.certificate, ".ply"));
    console.take(OutputFiles::can_write(request.certificate));
  }
}

}  // namespace cs2mesh
