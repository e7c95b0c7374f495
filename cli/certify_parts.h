// What of the meshes is proven: --certify and --certificate.
#pragma once

#include <string>
#include <vector>

#include "cli/mesh_parts.h"
#include "polygonize/certificate.h"
#include "polygonize/stage_log.h"

namespace cs2mesh {

struct PartCertificate {
  std::string name;
  Certificate certificate;
};

/// Certifies every part by itself, before parts are united. Of one with less than the share
/// `enough` of its area certified, triangles are cut where nothing can be proven of them as they
/// are; with less than 70 % it is meshed anew, to a quarter of the tolerance. Throws Exit
/// where that is interrupted or takes more cells than there may be.
std::vector<PartCertificate> certify_parts(MeshedScene& meshed, const CompiledScene& compiled,
                                           const Fineness& fineness, double enough,
                                           Console& console);

/// The part of all processor time so far that proofs took, 0..1: their stages are `topology` and
/// `certify`.
double share_of_time(const std::vector<StageCost>& costs);

/// Adds `certified`, the share of the area, `uncertified`, how many places there are of each
/// reason, and to `listed` the first 1000 of them of each part.
void add_certificates(Json& report, const std::vector<PartCertificate>& certificates);

/// Whether anything is in doubt.
bool any_doubt(const std::vector<PartCertificate>& certificates);

/// "99.98 % certified; 3 triangles or cells are not: distance 2, fold 1; the first at ...".
std::string summary(const std::vector<PartCertificate>& certificates);

/// The triangles in doubt, and the cells, as boxes: one part a reason, each of its own colour.
Model picture_of_doubts(const MeshedScene& meshed,
                        const std::vector<PartCertificate>& certificates);

/// Certifies the parts if that was asked for, and writes the picture if that was. Unless their
/// cells or number are set, meshes are made finer where that helps, with --certificate alone those
/// of which less than 99.92 % are certified. --certify throws Exit{kToleranceMissed}, the report
/// delivered, if anything is in doubt.
std::vector<PartCertificate> certify_if_asked(MeshedScene& meshed, const CompiledScene& compiled,
                                              const Fineness& fineness, const MeshRequest& request,
                                              Json report, Console& console);

}  // namespace cs2mesh
