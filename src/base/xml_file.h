// An XML file parsed into memory, with a limit on its size. Checks syntax only; callers check elements and attributes.
#pragma once

#include <tinyxml2.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace taxelsim {

class XmlFile {
 public:
  // Throws Error(kInput), one line that starts with the file's name, when it is missing, larger than max_bytes, or not well-formed.
  XmlFile(const std::filesystem::path& file, std::uintmax_t max_bytes);

  const std::string& name() const { return name_; }
  const tinyxml2::XMLElement* root() const { return document_.RootElement(); }  // null in an empty document

  // Throws Error(kInput) with the message "NAME:LINE: what".
  [[noreturn]] void fail(int line, const std::string& what) const;

 private:
  std::string name_;
  tinyxml2::XMLDocument document_;
};

}  // namespace taxelsim
