// A small XML file, read whole. Not a schema: who reads it says what may be in it.
#pragma once

#include <tinyxml2.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace taxelsim {

class XmlFile {
 public:
  // Throws Error(kInput), one line with the file's name: not there, larger than max_bytes, or not XML.
  XmlFile(const std::filesystem::path& file, std::uintmax_t max_bytes);

  const std::string& name() const { return name_; }
  const tinyxml2::XMLElement* root() const { return document_.RootElement(); }  // null where there is none

  // Throws Error(kInput): NAME:LINE: what.
  [[noreturn]] void fail(int line, const std::string& what) const;

 private:
  std::string name_;
  tinyxml2::XMLDocument document_;
};

}  // namespace taxelsim
