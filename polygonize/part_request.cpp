#include "polygonize/part_request.h"

namespace cs2mesh {

double length_scale(const Part& part) {
  if (part.thinnest_radius > 0) return part.thinnest_radius;
  const double diagonal = part.surface->bounds().diagonal();
  return diagonal > 0 ? 0.25 * diagonal : 1.0;
}

MesherRequest request_for(const Part& part, double tolerance, Progress* progress) {
  MesherRequest request;
  request.tolerance = tolerance;
  request.thinnest_radius = length_scale(part);
  request.creased = part.creased;
  request.progress = progress;
  return request;
}

void count_evaluations(CompiledScene& scene, EvaluationCounter& counter) {
  for (Part& part : scene.parts) {
    part.surface = std::make_shared<CountedSurface>(std::move(part.surface), &counter);
  }
}

}  // namespace cs2mesh
