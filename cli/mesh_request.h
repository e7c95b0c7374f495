// The command line of meshing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/options.h"
#include "polygonize/mesh_file.h"
#include "polygonize/mesher.h"

namespace cs2mesh {

struct MeshRequest {
  SceneOptions input;
  CommonOptions common;
  std::vector<std::string> outputs;
  std::optional<Length> tolerance;  ///< not set: the scene's, or 0.1 % of its diagonal
  std::optional<Length> cell;       ///< not set: the scene's, or what the tolerance needs
  std::string mesher{meshers().front().name};
  bool united = true;                   ///< parts that touch become one mesh
  std::optional<Length> component_min;  ///< smaller components are left out; not set: none
  std::optional<Length> min_feature;    ///< what is thinner may be lost; not set: nothing may
  bool outer = false;                   ///< what lies inside of others is left out
  std::vector<std::string> attributes;
  bool all_attributes = true;  ///< what format and scene have
  std::string up;              ///< "y", "z" or "": the scene's
  bool dry_run = false;
  bool balance = false;  ///< vertices may be off the surface
  bool verify = false;
  std::optional<std::size_t> max_triangles;  ///< which the tolerance then gives way to
  int levels = 0;                            ///< further ones, each coarser
  bool certify = false;
  std::string certificate;  ///< a PLY of what is in doubt
  bool self_intersections = true;
  std::string report;

  bool wants(const std::string& attribute) const;
  bool leaves_out() const { return component_min || outer; }
  /// Every level is measured.
  bool verifies() const { return verify || levels > 0; }
  /// Where level `level` goes: to the outputs themselves, or to horse.lod1.glb for horse.glb.
  /// Requires outputs with an extension.
  std::vector<std::string> outputs_of(int level) const;
  /// All files that are to be written.
  std::vector<std::string> files() const;
  /// Whether there must be a tolerance, so that the scene's cell does not count.
  bool needs_tolerance() const { return tolerance || max_triangles || min_feature || levels > 0; }
  bool wants_certificate() const { return certify || !certificate.empty(); }
  MeshFileOptions file_options(const Scene& scene) const;
};

/// Throws Exit where the usage is wrong or an output could not be written.
MeshRequest parse_mesh_request(const Words& arguments);
void require_writable(const MeshRequest& request, Console& console);

}  // namespace cs2mesh
