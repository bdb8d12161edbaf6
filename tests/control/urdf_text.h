// Generators of URDF text for tests.
#pragma once

#include "support/temporary_directory.h"
#include "support/test.h"

namespace taxelsim {

// A joint element; `more`: its other child elements.
inline std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                         const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" + more +
         "</joint>\n";
}

inline std::string robot(const std::string& elements) {
  return "<robot name='test'>\n" + elements + "</robot>\n";
}

inline const std::string kLimit = "<limit lower='-1' upper='1' effort='1' velocity='2'/>";
inline const std::string kLinks = "<link name='a'/><link name='b'/><link name='c'/>\n";
inline const std::filesystem::path kRobots = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/robots";

}  // namespace taxelsim
