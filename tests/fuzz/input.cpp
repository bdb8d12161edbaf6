#include "fuzz/input.h"

#include <fstream>

namespace taxelsim::fuzz {

namespace fs = std::filesystem;

InputFolder::InputFolder() {
  const fs::path scenes = fs::path(TAXELSIM_SOURCE_DIR) / "scenes";
  fs::create_directories(directory_ / "a/b");
  fs::create_directory(directory_ / "objects");
  for (const auto& entry : fs::directory_iterator(scenes / "objects")) {
    const fs::path name = entry.path().filename();
    const bool is_mesh = name.extension() == ".obj";
    fs::create_symlink(is_mesh ? scenes / "objects/edge_bar.obj" : entry.path(), directory_ / "objects" / name);
  }
  for (const char* const level : {".", "a", "a/b"}) {
    for (const auto& entry : fs::directory_iterator(scenes)) {
      const fs::path link = directory_.path() / level / entry.path().filename();
      if (!fs::exists(link)) fs::create_symlink(entry.path().filename() == "objects" ? directory_ / "objects" : entry.path(), link);
    }
  }
}

fs::path InputFolder::write(std::string_view name, std::string_view bytes) const {
  const fs::path file = directory_ / "a/b" / name;
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

const InputFolder& inputFolder() {
  static const InputFolder folder;
  return folder;
}

}  // namespace taxelsim::fuzz
