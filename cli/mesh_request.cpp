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
}

/// Options that concern the mesh as a whole.
void add_whole_options(CLI::App& app, MeshRequest& request) {
  add_length_option(app, "--component-min", request.component_min,
                    "leave out components whose box has a shorter diagonal than this: the mesh "
                    "keeps its distance from the surface, but the surface has more than the mesh");
  add_length_option(
      app, "--min-feature", request.min_feature,
      "necks, gaps and pieces thinner than this may be lost, for a faster run of the "
      "mesher that proves there are none: it does not cut cells below; JSON and words "
      "count those that may hide some")
      ->excludes("--cell");
  app.add_flag("--outer", request.outer,
               "likewise leave out voids and what is in them, so that what is seen from outside "
               "remains");
  app.add_option("--max-triangles", request.max_triangles,
                 "no more triangles than N: the mesh with the smallest tolerance, no smaller than "
                 "asked for, that a few meshings find; the JSON has the tolerance reached; status "
                 "6 if a quarter of the diagonal takes more")
      ->check(CLI::Range(std::size_t{4}, std::size_t{1} << 32))
      ->excludes("--cell")
      ->type_name("N");
  app.add_option("--lod", request.levels,
                 "also write N coarser levels of detail, each meshed anew to 4 times the tolerance "
                 "of the one before and measured as by --verify: OUT.lod1.EXT, OUT.lod2.EXT ...")
      ->check(CLI::Range(1, 8))
      ->excludes("--cell")
      ->type_name("N");
}

/// How far the mesh is to be trusted.
void add_proof_options(CLI::App& app, MeshRequest& request) {
  app.add_flag(
      "--verify", request.verify,
      "measure the result, as it will be written, both ways and with rays; where it is off, "
      "mesh it finer; status 5, and no mesh, if it still is");
  CLI::Option* certify =
      app.add_flag("--certify", request.certify,
                   "prove that the mesh is within the tolerance and of the surface's topology, "
                   "cutting triangles where that takes smaller ones; status 5, and no mesh, where "
                   "any of it could not be proven");
  CLI::Option* certificate =
      app.add_option("--certificate", request.certificate,
                     "prove it likewise, finer only where less than 99.92 % of the area is proven, "
                     "and write to this PLY file what could not be")
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

/// No file is to be written over another, as by levels of outputs of like names.
void require_apart(const std::vector<std::string>& files, Console& console) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!OutputFiles::same_file(files[i], files[j])) continue;
      console.fail(Failure::bad_input, "two outputs would be written to this file",
                   {files[i], 0, 0});
    }
  }
}

}  // namespace

std::vector<std::string> MeshRequest::outputs_of(int level) const {
  std::vector<std::string> paths;
  for (std::string path : outputs) {
    if (level > 0) path.insert(path.rfind('.'), ".lod" + std::to_string(level));
    paths.push_back(std::move(path));
  }
  return paths;
}

std::vector<std::string> MeshRequest::files() const {
  std::vector<std::string> all;
  for (int level = 0; level <= levels; ++level) {
    for (std::string& path : outputs_of(level)) all.push_back(std::move(path));
  }
  for (const std::string& path : {report, certificate}) {
    if (!path.empty()) all.push_back(path);
  }
  return all;
}

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
  add_whole_options(app, request);
  add_proof_options(app, request);
  add_output_options(app, request);
  add_limit_options(app, request.common);
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

void require_writable(const MeshRequest& request, Console& console) {
  if (request.min_feature && request.mesher != meshers().front().name) {
    console.fail(Failure::bad_input,
                 "--min-feature is for --mesher " + std::string(meshers().front().name) + " alone");
  }
  for (const std::string& path : request.outputs) {
    const std::optional<MeshFormat> format = mesh_format_of(path);
    if (!format || *format == MeshFormat::gltf || *format == MeshFormat::off) {
      console.fail(Failure::bad_input,
                   "no format to write by this extension, expected one of " +
                       std::string(writable_mesh_extensions()),
                   {path, 0, 0});
    }
  }
  const std::vector<std::string> files = request.files();
  require_apart(files, console);
  if (request.dry_run) return;
  for (const std::string& path : files) console.take(OutputFiles::can_write(path));
  if (!request.certificate.empty()) {
    console.take(OutputFiles::has_extension(request.certificate, ".ply"));
  }
}

}  // namespace cs2mesh
