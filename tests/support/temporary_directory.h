// A temporary directory, removed by the destructor, and contents of files.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

namespace taxelsim::testing {

class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "taxelsim-test-XXXXXX").string();  // mkdtemp() replaces the X
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

  // Writes a file, and makes its folder.
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

// Bytes of a file; none if there is no such file.
inline std::string contentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Contents by name of the files of a directory with one of these extensions, by default of all but locks; none if there is no such
// directory.
using Files = std::map<std::string, std::string>;
inline Files filesOf(const std::filesystem::path& directory, const std::set<std::string>& extensions = {}) {
  Files files;
  if (!std::filesystem::exists(directory)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const std::string name = entry.path().filename();
    const bool is_wanted = extensions.empty() ? name.find("lock") == std::string::npos : extensions.contains(entry.path().extension());
    if (is_wanted) files[name] = contentOf(entry.path());
  }
  return files;
}

}  // namespace taxelsim::testing
