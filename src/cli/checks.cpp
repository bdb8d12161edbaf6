#include <algorithm>
#include <cctype>
#include <filesystem>

#include "cli/commands.h"

namespace taxelsim::cli {

std::string refuseNegative(const std::string& text) {
  return text.starts_with('-') ? text + " is not 0 or more" : "";
}

std::string requirePngName(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" ? "" : file + ": pictures are PNG files, the name must end in .png";
}

CLI::Validator silent(CLI::Validator check) {
  return check.description("");
}

}  // namespace taxelsim::cli
