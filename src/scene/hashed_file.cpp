#include "scene/hashed_file.h"

#include <cctype>

#include "base/sha256.h"

namespace taxelsim {
namespace {

// Upper and lower case, as the mesh loader reads extensions.
bool isGltfName(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".gltf";
}

}  // namespace

std::filesystem::path readHashedFile(const YamlMap& map, std::string_view key, const std::filesystem::path& directory,
                                     std::uintmax_t max_bytes, std::string* sha256, const std::string& what) {
  const std::string text = what.empty() ? map.whatOf(key) : what;
  const YamlNode node = map.require(key, text);
  Canonical& canonical = map.canonical();
  std::filesystem::path file = directory / node.text(text);
  canonical.line(key, canonicalText(file.filename().string()));
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) node.fail(file.generic_string() + " is not there, or not a file");
  if (isGltfName(file)) {
    node.fail("a .gltf keeps its geometry in other files, which its SHA-256 does not cover: save it as .glb");
  }
  if (std::filesystem::file_size(file, error) > max_bytes || error) {
    node.fail(file.generic_string() + " is too large: at most " + std::to_string(max_bytes) + " bytes");
  }
  const std::string digest = atNode(node, [&] { return sha256File(file); });
  canonical.line("sha256", "\"" + digest + "\"");
  if (const std::optional<YamlNode> expected = map.find("sha256"); expected && expected->text("64 hexadecimal digits") != digest) {
    expected->fail("not the SHA-256 of " + file.generic_string() + ", which is " + digest);
  }
  if (sha256 != nullptr) *sha256 = digest;
  return file;
}

}  // namespace taxelsim
