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
  bool united = true;  ///< parts that touch become one mesh
  std::vector<std::string> attributes;
  bool all_attributes = true;  ///< what format and scene have
  std::string up;              ///< "y", "z" or "": the scene's
  bool dry_run = false;
  bool balance = false;  ///< vertices may be off the surface
  bool verify = false;
  bool certify = false;
  std::string certificate;  ///< a PLY of what is in doubt
  bool self_intersections = true;
  std::string report;

  bool wants(const std::string& attribute) const;
  bool wants_certificate() const { return certify || !certificate.empty(); }
  MeshFileOptions file_options(const Scene& scene) const;
};

/// Throws Exit where the usage is wrong or an output could not be written.
MeshRequest parse_mesh_request(const Words& arguments);
void require_writable(const MeshRequest& request, Console& console);

}  // namespace cs2mesh
