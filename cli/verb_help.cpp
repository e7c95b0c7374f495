// cs2mesh help: the manual, of the verbs and of the commands of the scene language.
#include <iostream>

#include "cli/exit_status.h"
#include "cli/verbs.h"
#include "libfield/art/command_table.h"

namespace cs2mesh {
namespace {

std::string_view words_for(CommandEffect effect) {
  switch (effect) {
    case CommandEffect::acts:
      return "";
    case CommandEffect::noted:
      return "Accepted; has no effect here.";
    case CommandEffect::left_out:
      return "Accepted with a warning; what it would add is left out.";
  }
  return "";
}

void print_command(const CommandRow& row) {
  std::cout << row.opcode;
  if (!row.arguments.empty()) std::cout << ' ' << row.arguments;
  std::cout << "\n  " << row.summary << '\n';
  if (row.effect != CommandEffect::acts) std::cout << "  " << words_for(row.effect) << '\n';
}

void print_commands() {
  std::string_view group;
  for (const CommandRow& row : command_table()) {
    if (name_of(row.group) != group) {
      group = name_of(row.group);
      std::cout << (&row == command_table().data() ? "" : "\n\n") << group << ':';
    }
    std::cout << ' ' << row.opcode;
  }
  std::cout << "\n\ncs2mesh help COMMAND says more about each.\n";
}

int say_unknown(const std::string& word) {
  std::vector<std::string_view> known = command_names();
  for (const Verb& verb : all_verbs()) known.push_back(verb.name);
  std::cerr << "cs2mesh: error: neither a verb nor a command of the language: '" << word << "'";
  const std::string_view nearest = nearest_word(word, known);
  if (!nearest.empty()) std::cerr << ", did you mean '" << nearest << "'?";
  std::cerr << '\n';
  return kBadInput;
}

}  // namespace

int run_help(const Words& arguments) {
  if (arguments.empty() || arguments[0] == "-h" || arguments[0] == "--help") {
    std::cout << overview();
    return kDone;
  }
  const std::string& word = arguments[0];
  if (word == "commands") {
    print_commands();
    return kDone;
  }
  if (word == "mesh") return run_mesh({"--help"});
  for (const Verb& verb : all_verbs()) {
    if (word == verb.name && verb.run != run_help) return verb.run({"--help"});
  }
  const CommandRow* row = find_command(word);
  if (row == nullptr) return say_unknown(word);
  print_command(*row);
  return kDone;
}

}  // namespace cs2mesh
