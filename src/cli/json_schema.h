// The tables of keys of a kind of file (scene/keys/block.h) for editors and documents.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace taxelsim::cli {

// JSON Schema, draft 7. `kind`: sensor, scene or robot.
nlohmann::ordered_json jsonSchema(const std::string& kind);

// One Markdown table for each block, each after a line "## name".
std::string keyTables(const std::string& kind);

}  // namespace taxelsim::cli
