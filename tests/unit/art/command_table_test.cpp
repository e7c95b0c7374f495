// The table of commands, against the thesis and against the language reference.
#include "libfield/art/command_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include "art_testing.h"

namespace cs2mesh {
namespace {

TEST(CommandTable, has_every_command_of_the_thesis) {
  // Appendix C.2, group by group.
  std::istringstream opcodes(
      "read pause return info help man test log var stopwatch quit "
      "aperture focus shutter vrp vup cp vpn window eyep fov texture surface "
      "arc arch box brick cone cylinder dot gauss line patch pipe polygon plane quadric sphere "
      "terra "
      "torus triad triangle chain object instance close translate rotate scale explode transform "
      "echo warning verbose bounds soft timer stat map double penumbra noview nosave dither gamma "
      "framesize filename format compress epsilon vanish maxdepth maxmol digger contrast pack "
      "indicator fragile sample mesh light fog background cloud remove report reset preview shoot "
      "animate play split collage fli convert resize diff and xor show kill refresh tile colors "
      "rats "
      "table shell horn");
  std::size_t count = 0;
  for (std::string opcode; opcodes >> opcode; ++count) {
    EXPECT_NE(find_command(opcode), nullptr) << opcode;
  }
  EXPECT_EQ(command_table().size(), count + 2);  // and blend, import
  EXPECT_EQ(std::set(command_names().begin(), command_names().end()).size(), count + 2);
}

TEST(CommandTable, every_command_is_accepted_and_those_that_do_not_act_are_named) {
  for (const CommandRow& row : command_table()) {
    EXPECT_EQ(row.effect == CommandEffect::acts, row.handler != nullptr) << row.opcode;
    EXPECT_EQ(find_command(row.opcode), &row);
    if (row.effect == CommandEffect::acts) continue;
    const std::string opcode(row.opcode);
    const Result<Scene> scene = parse_art(opcode + " a b c\n" + opcode + "\n", "f");
    ASSERT_TRUE(scene) << opcode;
    ASSERT_EQ(scene.diagnostics().size(), 1u) << opcode;
    const Diagnostic& d = scene.diagnostics()[0];
    EXPECT_NE(d.message.find("'" + opcode + "'"), std::string::npos);
    EXPECT_EQ(d.severity, row.effect == CommandEffect::noted ? Severity::note : Severity::warning);
    EXPECT_TRUE(d.message.ends_with("(and 1 more)")) << d.message;
  }
  EXPECT_EQ(find_command("sph"), nullptr);
}

std::string in_a_table(std::string_view text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

TEST(CommandTable, is_the_table_of_the_language_reference) {
  std::ifstream stream(std::string(CS2MESH_SOURCE_DIR) + "/docs/language.md");
  const std::string reference{std::istreambuf_iterator<char>(stream), {}};
  for (const CommandRow& row : command_table()) {
    const std::string arguments =
        row.arguments.empty() ? "" : "`" + in_a_table(row.arguments) + "`";
    std::string line = "\n| `" + std::string(row.opcode) + "` | " + arguments + " | ";
    line += row.effect == CommandEffect::left_out ? "**left out**, with a warning"
                                                  : in_a_table(row.summary) + " |\n";
    EXPECT_NE(reference.find(line), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace cs2mesh
