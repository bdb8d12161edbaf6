#include "base/xml_file.h"

#include "base/files.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {

XmlFile::XmlFile(const std::filesystem::path& file, std::uintmax_t max_bytes) : name_(file.generic_string()) {
  const std::string bytes = readTextFile(file, max_bytes);
  if (document_.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    fail(document_.ErrorLineNum(), std::string("is not XML: ") + tinyxml2::XMLDocument::ErrorIDToName(document_.ErrorID()));
  }
}

void XmlFile::fail(int line, const std::string& what) const {
  throw Error(ErrorKind::kInput, oneLine(name_ + ":" + std::to_string(line) + ": " + what));
}

}  // namespace taxelsim
