// Files for fuzz targets, and checks of how loaders refuse them.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "support/temporary_directory.h"
#include "taxelsim/error.h"

namespace taxelsim::fuzz {

// A finding unless the condition holds.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

// A temporary directory for the lifetime of the program. Inputs are in `a/b/` of it; each level has the folders of scenes/, so that
// relative paths of shipped files lead to shipped files. All meshes are the same small one: large ones are slow.
class InputFolder {
 public:
  InputFolder();

  // Writes an input and returns its path.
  std::filesystem::path write(std::string_view name, std::string_view bytes) const;

 private:
  testing::TemporaryDirectory directory_;
};

const InputFolder& inputFolder();

// Calls `load`. Returns whether it accepts the input; checks the error otherwise.
template <typename Load>
bool accepts(Load load) {
  try {
    load();
  } catch (const Error& error) {
    const std::string message = error.what();
    require(error.kind() == ErrorKind::kInput, "not an error of the input: " + message);
    require(!message.empty() && message.find('\n') == std::string::npos, "not one line: " + message);
    return false;
  }
  return true;
}

}  // namespace taxelsim::fuzz
