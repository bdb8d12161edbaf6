#include "base/xml_file.h"

#include <fstream>
#include <sstream>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {

XmlFile::XmlFile(const std::filesystem::path& file, std::uintmax_t max_bytes) : name_(file.generic_string()) {
  const auto reject = [&](const std::string& what) { throw Error(ErrorKind::kInput, oneLine(name_ + ": " + what)); };
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) reject("no such file, or not a regular file");
  if (std::filesystem::file_size(file, error) > max_bytes) reject("is larger than " + std::to_string(max_bytes >> 20) + " MiB");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) reject("cannot be read");
  const std::string bytes = text.str();
  if (document_.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    fail(document_.ErrorLineNum(), std::string("is not XML: ") + tinyxml2::XMLDocument::ErrorIDToName(document_.ErrorID()));
  }
}

void XmlFile::fail(int line, const std::string& what) const {
  throw Error(ErrorKind::kInput, oneLine(name_ + ":" + std::to_string(line) + ": " + what));
}

}  // namespace taxelsim
