// Meshes of parts that touch -> one mesh.
#include <algorithm>
#include <map>

#include "cli/mesh_parts.h"
#include "polygonize/crease_refinement.h"
#include "polygonize/unite.h"

namespace cs2mesh {
namespace {

/// What the meshes are known to be within.
double tolerance_of(const MeshedScene& meshed, const CompiledScene& compiled,
                    const Fineness& fineness) {
  if (!(fineness.cell > 0)) return fineness.tolerance;
  double largest = 1e-9 * compiled.extent.diagonal();
  for (const PartLog& log : meshed.log) largest = std::max(largest, log.error);
  return largest;
}

/// What is to be said of a union of parts.
void merge(PartLog& into, const PartLog& log) {
  into.cell = std::min(into.cell, log.cell);
  into.error = std::max(into.error, log.error);
  if (into.unresolved_cells && log.unresolved_cells) {
    *into.unresolved_cells += *log.unresolved_cells;
  } else {
    into.unresolved_cells.reset();
  }
}

}  // namespace

void unite_parts(MeshedScene& meshed, const CompiledScene& compiled, const Fineness& fineness,
                 Console& console) {
  if (meshed.model.parts.size() < 2) return;
  UniteOptions options;
  options.tolerance = tolerance_of(meshed, compiled, fineness);
  options.progress = &console.progress();
  std::map<std::string, std::size_t> number;  // of each part before, by its name
  std::vector<const ImplicitSurface*> surfaces;
  for (std::size_t i = 0; i < meshed.model.parts.size(); ++i) {
    const Part& part = compiled.parts[meshed.parts_of[i].front()];
    number.emplace(part.name, i);
    surfaces.push_back(part.surface.get());
    options.where.push_back(part.where);
  }
  // Cells of a size that was asked for come without a promise about the distance.
  if (!(fineness.cell > 0)) {
    refine_at_creases(surfaces, meshed.model, options.tolerance, options.progress);
  }
  Result<Model> united = unite(std::move(meshed.model), options);
  if (!united && united.diagnostics().back().failure != Failure::interrupted) {
    const Diagnostic& why = united.diagnostics().back();
    console.fail(why.failure,
                 why.message + "; nothing was written (--parts separate writes them one by one)",
                 why.where);
  }
  MeshedScene done;
  done.model = console.take(std::move(united));
  std::vector<char> used(number.size());
  for (const MeshPart& part : done.model.parts) {
    const std::vector<std::string> alone{part.name};
    PartLog log;
    std::vector<std::size_t>& parts = done.parts_of.emplace_back();
    for (const std::string& name : part.sources.empty() ? alone : part.sources) {
      const std::size_t i = number.at(name);
      used[i] = 1;
      if (parts.empty()) {
        log = meshed.log[i];
      } else {
        merge(log, meshed.log[i]);
      }
      parts.push_back(meshed.parts_of[i].front());
    }
    log.name = part.name;
    done.log.push_back(std::move(log));
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) done.swallowed.push_back(std::move(meshed.log[i]));
  }
  meshed = std::move(done);
}

}  // namespace cs2mesh
