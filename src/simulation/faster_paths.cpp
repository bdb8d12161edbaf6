#include "simulation/faster_paths.h"

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::array<std::pair<std::string_view, bool FasterPaths::*>, 6> kNames{{{"pairs", &FasterPaths::pairs},
                                                                                  {"polyhedra", &FasterPaths::polyhedra},
                                                                                  {"untouched", &FasterPaths::untouched},
                                                                                  {"candidates", &FasterPaths::candidates},
                                                                                  {"lockstep", &FasterPaths::lockstep},
                                                                                  {"alone", &FasterPaths::alone}}};

void switchOff(FasterPaths& paths, std::string_view name) {
  bool is_known = false;
  for (const auto& [known, path] : kNames) {
    if (name != known && name != "all") continue;
    paths.*path = false;
    is_known = true;
  }
  if (is_known) return;
  std::string allowed;
  for (const auto& [known, path] : kNames) allowed += std::string(known) + ", ";
  throw Error(ErrorKind::kInput, "TAXELSIM_PLAIN: \"" + std::string(name) + "\" is not allowed: " + allowed + "all");
}

}  // namespace

FasterPaths fasterPaths() {
  FasterPaths paths;
  const char* value = std::getenv("TAXELSIM_PLAIN");
  std::string_view left = value == nullptr ? "" : value;
  while (!left.empty()) {
    const std::size_t comma = left.find(',');
    switchOff(paths, left.substr(0, comma));
    left = comma == std::string_view::npos ? "" : left.substr(comma + 1);
  }
  return paths;
}

}  // namespace taxelsim
