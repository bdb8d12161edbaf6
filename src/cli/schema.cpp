// `taxelsim schema`: the keys of sensor, scene and robot files, for editors and documents.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/json_schema.h"
#include "cli/print.h"

namespace taxelsim::cli {
namespace {

struct SchemaArguments {
  std::string kind;
  bool markdown = false;
};

}  // namespace

void addSchema(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("schema", "Print the keys of sensor, scene and robot files as JSON Schema");
  command->footer(
      "Example:\n  taxelsim schema scene > scene.schema.json\n"
      "An editor that reads JSON Schema completes keys, shows their meaning, unit and default, and marks mistakes. In VS Code with the "
      "extension YAML, the first line of a file names the schema: # yaml-language-server: $schema=scene.schema.json");
  const auto arguments = std::make_shared<SchemaArguments>();
  command->add_option("kind", arguments->kind, "sensor, scene or robot")
      ->required()
      ->check(silent(CLI::IsMember({"sensor", "scene", "robot"})))
      ->type_name("KIND");
  command->add_flag("--markdown", arguments->markdown, "Print tables in Markdown instead");
  command->callback([arguments, &action] {
    action = [arguments] {
      if (arguments->markdown) {
        printOut("{}", keyTables(arguments->kind));
      } else {
        printJsonText(jsonSchema(arguments->kind));
      }
      return kExitOk;
    };
  });
}

}  // namespace taxelsim::cli
