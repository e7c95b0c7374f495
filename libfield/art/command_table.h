// The commands of the scene language: one row each.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "libfield/art/scene_builder.h"

namespace cs2mesh {

enum class CommandGroup { run, camera, materials, primitives, objects, options, scene, tools };

/// The thesis's word for a group, in lower case.
std::string_view name_of(CommandGroup group);

enum class CommandEffect {
  acts,      ///< its handler does what the language says
  noted,     ///< means nothing to a batch tool, or nothing to a surface; accepted with a note
  left_out,  ///< would change the surface; accepted with a warning that it is left out
};

struct CommandRow {
  std::string_view opcode;
  CommandGroup group;
  std::string_view arguments;  ///< as the manual writes them
  std::string_view summary;    ///< what it does here
  CommandEffect effect;
  void (*handler)(SceneBuilder& builder, Arguments& args);  ///< null unless the command acts
};

/// All commands, by group.
std::span<const CommandRow> command_table();

/// The row of an opcode, or null.
const CommandRow* find_command(std::string_view opcode);

/// All opcodes.
const std::vector<std::string_view>& command_names();

/// Runs one command on the scene; reports what is wrong with it.
void execute(const Command& command, const std::string& file, SceneBuilder& builder);

}  // namespace cs2mesh
