#include "cli/load_scene.h"

#include "libfield/art/read_art.h"

namespace cs2mesh {

Scene read_scene(const SceneOptions& options, Console& console, Stopwatch& watch) {
  watch.start("parse");
  ReadArtOptions reading;
  reading.defines = options.defines;
  Scene scene = console.take(read_art(options.path, reading));
  if (options.bounds) scene.mesh.bounds = options.bounds;
  watch.stop();
  console.stop_if_interrupted();
  return scene;
}

CompiledScene bounded_parts(const Scene& scene, Console& console, Stopwatch& watch) {
  watch.start("compile");
  CompiledScene compiled = console.take(clip_to_bounds(console.take(compile(scene)), scene));
  watch.stop();
  console.stop_if_interrupted();
  return compiled;
}

}  // namespace cs2mesh
