// Control of reading: files and variables.
#include "libfield/art/colors.h"
#include "libfield/art/commands.h"
#include "libfield/art/number.h"

namespace cs2mesh::commands {
namespace {

/// What a single word stands for where that is no number: a variable's value, a surface, a texture,
/// a colour, in this order.
Value value_of_word(Arguments& args, std::string_view word) {
  const Symbols& symbols = args.symbols();
  if (const Value* value = find(symbols.variables, word)) return *value;
  if (const MaterialIndex* surface = find(symbols.surfaces, word)) return *surface;
  if (const Texture* texture = find(symbols.textures, word)) return *texture;
  if (const auto color = color_of(word)) return *color;
  args.fail(args.here(), "found " + in_quotes(word) +
                             ", expected a number, a variable, a surface, a texture or a color" +
                             did_you_mean(word, color_names()));
  return BrokenValue{};
}

Value read_value(Arguments& args) {
  const auto values_left = [&] { return args.left() - (args.last_is("hot") ? 1 : 0); };
  if (values_left() == 3) return args.triple("a number");
  const std::string_view word = args.peek();
  if (word.empty() || parse_number(word).status != NumberStatus::not_a_number) {
    return args.number("a value: one number, three numbers or a name");
  }
  Value value = value_of_word(args, word);
  if (!args.failed()) args.skip();
  return value;
}

}  // namespace

void read(SceneBuilder& builder, Arguments& args) {
  std::vector<ReadRequest> requests;
  do {
    const SourceLocation where = args.here();
    requests.push_back({std::string(args.word("the name of a file")), where});
  } while (args.more());
  if (args.finish()) builder.reads = std::move(requests);
}

void return_(SceneBuilder& builder, Arguments& args) {
  if (args.finish()) builder.leave_file = true;
}

void quit(SceneBuilder& builder, Arguments& args) {
  if (args.finish()) builder.leave_all = true;
}

void var(SceneBuilder& builder, Arguments& args) {
  const SourceLocation where = args.here();
  const std::string_view name = args.word("the name of a variable");
  if (!args.failed() && (name == "=" || parse_number(name).status == NumberStatus::ok)) {
    args.fail(where, "found " + in_quotes(name) + ", expected the name of a variable");
  }
  const SourceLocation equals = args.here();
  const std::string_view sign = args.word("'=' and a value");
  if (!args.failed() && sign != "=") {
    args.fail(equals, "found " + in_quotes(sign) + ", expected '=' and a value");
  }
  Value value = args.failed() ? Value{BrokenValue{}} : read_value(args);
  if (!args.failed() && args.peek() == "hot") args.skip();
  if (!args.finish()) value = BrokenValue{};
  // Known even when it is wrong, so that its uses are not reported too.
  if (!name.empty() && builder.has_room_for_name(args, builder.symbols().variables.size())) {
    builder.set_variable(name, std::move(value));
  }
}

}  // namespace cs2mesh::commands
