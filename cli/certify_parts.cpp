#include "cli/certify_parts.h"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/interrupt.h"
#include "cli/output_files.h"
#include "polygonize/part_request.h"
#include "polygonize/ply.h"

namespace cs2mesh {
namespace {

constexpr std::array kReasons{Doubt::distance, Doubt::fold, Doubt::topology, Doubt::crease,
                              Doubt::profile};

/// Linear RGB: red, yellow, blue, magenta, green.
Vec3<float> color_of(Doubt doubt) {
  switch (doubt) {
    case Doubt::distance:
      return {0.8F, 0.02F, 0.02F};
    case Doubt::fold:
      return {0.8F, 0.6F, 0.0F};
    case Doubt::topology:
      return {0.02F, 0.1F, 0.8F};
    case Doubt::profile:
      return {0.05F, 0.6F, 0.05F};
    default:
      return {0.7F, 0.02F, 0.6F};
  }
}

std::size_t count(const std::vector<PartCertificate>& certificates, Doubt doubt) {
  std::size_t n = 0;
  for (const auto& [name, certificate] : certificates) {
    for (const UncertifiedPlace& place : certificate.places) n += place.doubt == doubt ? 1 : 0;
  }
  return n;
}

double share(const std::vector<PartCertificate>& certificates) {
  double area = 0.0, certified = 0.0;
  for (const auto& [name, certificate] : certificates) {
    area += certificate.area;
    certified += certificate.certified_area;
  }
  return area > 0 ? certified / area : 1.0;
}

void append_triangle(TriangleMesh& mesh, const std::array<Vec3d, 3>& corners) {
  const auto first = static_cast<TriangleMesh::Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void append_box(TriangleMesh& mesh, const Aabb& box) {
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& face : kFaces) {
    append_triangle(mesh, {box.corner(face[0]), box.corner(face[1]), box.corner(face[2])});
    append_triangle(mesh, {box.corner(face[0]), box.corner(face[2]), box.corner(face[3])});
  }
}

/// Certifies a part, with a mesh that can be certified if that one cannot.
class PartCertifier {
 public:
  /// `enough`: the share of the area from which on the mesh stays what it is.
  PartCertifier(const Part& part, const Fineness& fineness, double enough, Console& console)
      : part_(part), fineness_(fineness), console_(console) {
    // What necks and gaps are larger than, as a part of the thinnest radius.
    constexpr double kNeck = 1.0 / 64;
    // Where the tolerance is as large as what the surface consists of, cutting triangles makes many
    // more of them than a mesh has that is made to a part of the tolerance.
    constexpr double kHopeless = 0.7;
    TopologyProof::Options proof;
    proof.smallest = kNeck * length_scale(part);
    proof.progress = &console.progress();
    topology_.emplace(console.take(TopologyProof::build(*part.surface, proof)));
    options_.tolerance = fineness.tolerance;
    options_.enough = enough;
    options_.hopeless = kHopeless;
    if (enough < 1) {
      options_.rounds = 1;
      options_.worth = 0.5;
    }
    options_.progress = &console.progress();
  }

  Certificate certify(TriangleMesh& mesh, PartLog& log) {
    if (options_.enough == 0) {
      return console_.take(cs2mesh::certify(*part_.surface, mesh, *topology_, options_));
    }
    Certificate best = refined(mesh);
    if (best.share() < options_.hopeless) mesh_finer(mesh, log, best);
    return best;
  }

 private:
  Certificate refined(TriangleMesh& mesh) {
    return console_.take(certify_refined(*part_.surface, mesh, *topology_, options_));
  }

  void mesh_finer(TriangleMesh& mesh, PartLog& log, Certificate& best) {
    constexpr double kFiner = 0.25;
    Fineness finer = fineness_;
    finer.tolerance *= kFiner;
    Result<MesherResult> made = mesh_part(part_, finer, console_);
    console_.stop_if_interrupted();
    if (!made || !made->reached || made->mesh.empty()) return;
    Certificate then = refined(made->mesh);
    if (!(1 - then.share() < options_.worth * (1 - best.share()))) return;
    best = std::move(then);
    mesh = std::move(made->mesh);
    log.cell = made->cell;
    log.error = made->error;
    log.unresolved_cells = made->unresolved_cells;
  }

  const Part& part_;
  const Fineness& fineness_;
  Console& console_;
  std::optional<TopologyProof> topology_;
  CertifyOptions options_;
};

}  // namespace

std::vector<PartCertificate> certify_parts(MeshedScene& meshed, const CompiledScene& compiled,
                                           const Fineness& fineness, double enough,
                                           Console& console) {
  std::vector<PartCertificate> certificates;
  for (std::size_t i = 0; i < meshed.model.parts.size(); ++i) {
    const Part& part = compiled.parts[meshed.parts_of[i].front()];
    PartCertifier certifier(part, fineness, enough, console);
    certificates.push_back(
        {part.name, certifier.certify(meshed.model.parts[i].mesh, meshed.log[i])});
  }
  return certificates;
}

double share_of_time(const std::vector<StageCost>& costs) {
  double all = 0.0, proofs = 0.0;
  for (const StageCost& cost : costs) {
    all += cost.cpu_seconds;
    if (cost.stage == "topology" || cost.stage == "certify") proofs += cost.cpu_seconds;
  }
  return all > 0 ? proofs / all : 0.0;
}

void add_certificates(Json& report, const std::vector<PartCertificate>& certificates) {
  constexpr std::size_t kMost = 1000;
  report["certified"] = share(certificates);
  Json counts = Json::object();
  for (const Doubt doubt : kReasons) counts[std::string(name(doubt))] = count(certificates, doubt);
  report["uncertified"] = std::move(counts);
  Json& listed = report["listed"];
  for (const auto& [part, certificate] : certificates) {
    for (std::size_t i = 0; i < std::min(kMost, certificate.places.size()); ++i) {
      const UncertifiedPlace& place = certificate.places[i];
      listed.push_back({{"position", to_json(place.position)},
                        {"reason", name(place.doubt)},
                        {"part", part},
                        {"area", place.area}});
    }
  }
}

bool any_doubt(const std::vector<PartCertificate>& certificates) {
  for (const auto& [name, certificate] : certificates) {
    if (!certificate.places.empty()) return true;
  }
  return false;
}

std::string summary(const std::vector<PartCertificate>& certificates) {
  char text[256];
  std::snprintf(text, sizeof text, "%.4f %% of the area certified", 100 * share(certificates));
  std::string line = text;
  for (const Doubt doubt : kReasons) {
    const std::size_t n = count(certificates, doubt);
    if (n > 0) line += ", in doubt for " + std::string(name(doubt)) + ": " + std::to_string(n);
  }
  for (const auto& [part, certificate] : certificates) {
    if (certificate.places.empty()) continue;
    const Vec3d& at = certificate.places.front().position;
    std::snprintf(text, sizeof text, ", the first at (%.9g, %.9g, %.9g)", at.x, at.y, at.z);
    return line + text;
  }
  return line;
}

Model picture_of_doubts(const MeshedScene& meshed,
                        const std::vector<PartCertificate>& certificates) {
  Model model;
  for (const Doubt doubt : kReasons) {
    MeshPart part{std::string(name(doubt)), {}};
    for (std::size_t i = 0; i < certificates.size(); ++i) {
      const TriangleMesh& mesh = meshed.model.parts[i].mesh;
      const Certificate& certificate = certificates[i].certificate;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (certificate.doubts[t] != doubt) continue;
        const auto& c = mesh.triangles[t];
        append_triangle(part.mesh,
                        {mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]});
      }
      for (const UncertifiedPlace& place : certificate.places) {
        if (place.doubt == doubt && place.area == 0) append_box(part.mesh, place.box);
      }
    }
    part.mesh.colors.assign(part.mesh.positions.size(), color_of(doubt));
    if (!part.mesh.empty()) model.parts.push_back(std::move(part));
  }
  return model;
}

std::vector<PartCertificate> certify_if_asked(MeshedScene& meshed, const CompiledScene& compiled,
                                              const Fineness& fineness, const MeshRequest& request,
                                              Json report, Console& console) {
  if (!request.wants_certificate()) return {};
  constexpr double kNearlyAll = 0.9992;
  const bool as_it_is = fineness.cell > 0 || fineness.budgeted;
  const double enough = as_it_is ? 0.0 : request.certify ? 1.0 : kNearlyAll;
  std::vector<PartCertificate> certificates =
      certify_parts(meshed, compiled, fineness, enough, console);
  console.say(summary(certificates));
  if (!request.certificate.empty()) {
    const WhileWriting guard;
    OutputFiles files;
    console.take(files.write(request.certificate, [&](const std::string& at) {
      return write_ply(picture_of_doubts(meshed, certificates), at);
    }));
    console.take(files.commit());
  }
  if (request.certify && any_doubt(certificates)) {
    add_certificates(report, certificates);
    deliver(report, request.report, console);
    console.fail(Failure::tolerance, "not all of the mesh is certified; no mesh was written",
                 {request.input.path, 0, 0});
  }
  return certificates;
}

}  // namespace cs2mesh
