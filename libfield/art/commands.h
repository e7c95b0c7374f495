// The handlers of the commands that act, by group; command_table.cpp says which is whose.
#pragma once

#include "libfield/art/scene_builder.h"

namespace cs2mesh::commands {

// commands_run.cpp
void read(SceneBuilder& builder, Arguments& args);
void return_(SceneBuilder& builder, Arguments& args);
void quit(SceneBuilder& builder, Arguments& args);
void var(SceneBuilder& builder, Arguments& args);

// commands_camera.cpp
void vrp(SceneBuilder& builder, Arguments& args);
void vup(SceneBuilder& builder, Arguments& args);
void eyep(SceneBuilder& builder, Arguments& args);
void fov(SceneBuilder& builder, Arguments& args);
void framesize(SceneBuilder& builder, Arguments& args);
void sample(SceneBuilder& builder, Arguments& args);

// commands_texture.cpp, commands_surface.cpp
void texture(SceneBuilder& builder, Arguments& args);
void surface(SceneBuilder& builder, Arguments& args);

// commands_primitives.cpp
void arc(SceneBuilder& builder, Arguments& args);
void arch(SceneBuilder& builder, Arguments& args);
void box(SceneBuilder& builder, Arguments& args);
void brick(SceneBuilder& builder, Arguments& args);
void cone(SceneBuilder& builder, Arguments& args);
void cylinder(SceneBuilder& builder, Arguments& args);
void dot(SceneBuilder& builder, Arguments& args);
void gauss(SceneBuilder& builder, Arguments& args);
void line(SceneBuilder& builder, Arguments& args);
void pipe(SceneBuilder& builder, Arguments& args);
void plane(SceneBuilder& builder, Arguments& args);
void polygon(SceneBuilder& builder, Arguments& args);
void quadric(SceneBuilder& builder, Arguments& args);
void sphere(SceneBuilder& builder, Arguments& args);
void torus(SceneBuilder& builder, Arguments& args);
void triangle(SceneBuilder& builder, Arguments& args);

// commands_objects.cpp
void chain(SceneBuilder& builder, Arguments& args);
void object(SceneBuilder& builder, Arguments& args);
void instance(SceneBuilder& builder, Arguments& args);
void close(SceneBuilder& builder, Arguments& args);
void translate(SceneBuilder& builder, Arguments& args);
void rotate(SceneBuilder& builder, Arguments& args);
void scale(SceneBuilder& builder, Arguments& args);
void blend(SceneBuilder& builder, Arguments& args);
void remove(SceneBuilder& builder, Arguments& args);

// commands_options.cpp
void soft(SceneBuilder& builder, Arguments& args);
void fragile(SceneBuilder& builder, Arguments& args);
void mesh(SceneBuilder& builder, Arguments& args);

// commands_scene.cpp
void light(SceneBuilder& builder, Arguments& args);
void background(SceneBuilder& builder, Arguments& args);
void reset(SceneBuilder& builder, Arguments& args);

}  // namespace cs2mesh::commands
