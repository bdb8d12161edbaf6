#include <algorithm>
#include <sstream>
#include <string_view>

#include "taxelsim/scene.h"

namespace taxelsim {

// Messages about the result have the line numbers of `recorded`.
std::string readableScene(const std::string& recorded) {
  std::istringstream lines(recorded);
  std::string result;
  bool is_pasternak = false;
  for (std::string line; std::getline(lines, line); result += line + "\n") {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::string_view setting = std::string_view(line).substr(indent);
    if (setting.starts_with("law: ")) {
      is_pasternak = setting == "law: pasternak";
      if (is_pasternak) line.replace(indent, std::string::npos, "law: winkler");
    } else if (is_pasternak && (setting.starts_with("shear_stiffness: ") || setting.starts_with("iterations: "))) {
      line.replace(indent, std::string::npos, "#");  // no empty line, which would end the block for readers of the text
    }
  }
  return result;
}

}  // namespace taxelsim
