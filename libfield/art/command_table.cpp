#include "libfield/art/command_table.h"

#include <algorithm>
#include <string>

#include "libfield/art/commands.h"

namespace cs2mesh {
namespace {

using enum CommandGroup;
using enum CommandEffect;

constexpr CommandRow kTable[] = {
#include "libfield/art/command_table.inc"
};

}  // namespace

std::string_view name_of(CommandGroup group) {
  constexpr std::string_view kNames[] = {"run",     "camera",  "materials", "primitives",
                                         "objects", "options", "scene",     "tools"};
  return kNames[static_cast<std::size_t>(group)];
}

std::span<const CommandRow> command_table() {
  return kTable;
}

const std::vector<std::string_view>& command_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const CommandRow& row : kTable) all.push_back(row.opcode);
    return all;
  }();
  return names;
}

const CommandRow* find_command(std::string_view opcode) {
  static const std::vector<const CommandRow*> sorted = [] {
    std::vector<const CommandRow*> rows;
    for (const CommandRow& row : kTable) rows.push_back(&row);
    std::sort(rows.begin(), rows.end(),
              [](const CommandRow* a, const CommandRow* b) { return a->opcode < b->opcode; });
    return rows;
  }();
  const auto found = std::lower_bound(
      sorted.begin(), sorted.end(), opcode,
      [](const CommandRow* row, std::string_view name) { return row->opcode < name; });
  return found != sorted.end() && (*found)->opcode == opcode ? *found : nullptr;
}

void execute(const Command& command, const std::string& file, SceneBuilder& builder) {
  const std::string_view opcode = command.opcode.text;
  const CommandRow* const row = find_command(opcode);
  if (!row) {
    // The thesis's text writes `material` where its language has `surface`.
    const std::string hint =
        opcode == "material" ? ", did you mean 'surface'?" : did_you_mean(opcode, command_names());
    builder.log().error(locate(file, command.opcode),
                        "unknown command " + in_quotes(opcode) +
                            ", expected a command of the scene language" + hint);
    return;
  }
  Arguments args(command, file, builder.symbols(), builder.log());
  switch (row->effect) {
    case acts:
      row->handler(builder, args);
      break;
    case noted:
      builder.log().once(Severity::note, opcode, args.opcode_location(),
                         in_quotes(opcode) + " does " + std::string(row->summary));
      break;
    case left_out:
      builder.log().once(Severity::warning, opcode, args.opcode_location(),
                         in_quotes(opcode) + " is not supported, it is left out");
      break;
  }
}

}  // namespace cs2mesh
