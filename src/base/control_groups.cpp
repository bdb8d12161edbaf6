#include "base/control_groups.h"

#include <fstream>

namespace taxelsim {
namespace {

void addGroup(std::vector<std::filesystem::path>& folders, std::filesystem::path group, const std::filesystem::path& mount) {
  folders.push_back(mount);  // inside a container the mount is its own group
  for (; group.has_relative_path(); group = group.parent_path()) folders.push_back(mount / group.relative_path());
}

}  // namespace

ControlGroups controlGroups(const std::filesystem::path& groups, const std::filesystem::path& mount, const std::string& controller) {
  std::ifstream stream(groups);
  ControlGroups found;
  for (std::string line; std::getline(stream, line);) {  // "0::/user.slice", "4:memory:/jobs/7"
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::filesystem::path group = line.substr(second + 1);
    if (controllers == ",,") addGroup(found.version_2, group, mount);
    if (controllers.find("," + controller + ",") != std::string::npos) addGroup(found.version_1, group, mount / controller);
  }
  return found;
}

}  // namespace taxelsim
