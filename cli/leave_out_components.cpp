// --component-min and --outer: components of the meshes that are not wanted.
#include <nlohmann/json.hpp>

#include "cli/mesh_parts.h"
#include "cli/printed.h"

namespace cs2mesh {
namespace {

std::string text_of(const LeftOut::Tally& tally, const std::string& kind) {
  return "left out: " + std::to_string(tally.components) + " " + kind +
         (tally.components == 1 ? " component (" : " components (") + std::to_string(tally.voids) +
         (tally.voids == 1 ? " void)" : " voids)") + " of area " + printed("%.6g", tally.area);
}

/// Takes out the parts that have no triangles any more.
void drop_empty_parts(MeshedScene& meshed) {
  MeshedScene rest;
  rest.swallowed = std::move(meshed.swallowed);
  for (std::size_t i = 0; i < meshed.model.parts.size(); ++i) {
    if (meshed.model.parts[i].mesh.empty()) continue;
    rest.model.parts.push_back(std::move(meshed.model.parts[i]));
    rest.log.push_back(std::move(meshed.log[i]));
    rest.parts_of.push_back(std::move(meshed.parts_of[i]));
  }
  meshed = std::move(rest);
}

}  // namespace

LeaveOutOptions leave_out_options(const MeshRequest& request, const CompiledScene& compiled,
                                  Console& console) {
  LeaveOutOptions options;
  if (request.component_min) {
    options.smallest = request.component_min->absolute(compiled.extent.diagonal());
  }
  options.enclosed = request.outer;
  options.across_parts = request.united;
  options.progress = &console.progress();
  return options;
}

LeftOut leave_out(MeshedScene& meshed, const CompiledScene& compiled, const MeshRequest& request,
                  Console& console) {
  if (!request.leaves_out()) return {};
  const LeftOut left_out = leave_out(meshed.model, leave_out_options(request, compiled, console));
  console.stop_if_interrupted();
  if (left_out.small.components > 0) console.say(text_of(left_out.small, "small"));
  if (left_out.enclosed.components > 0) console.say(text_of(left_out.enclosed, "enclosed"));
  drop_empty_parts(meshed);
  if (meshed.model.parts.empty()) {
    console.fail(Failure::bad_input,
                 "all components are smaller than --component-min; nothing was written",
                 {request.input.path, 0, 0});
  }
  return left_out;
}

Json to_json(const LeftOut& left_out) {
  const auto tally = [](const LeftOut::Tally& of) {
    return Json{{"components", of.components}, {"voids", of.voids}, {"area", of.area}};
  };
  return {{"small", tally(left_out.small)}, {"enclosed", tally(left_out.enclosed)}};
}

}  // namespace cs2mesh
