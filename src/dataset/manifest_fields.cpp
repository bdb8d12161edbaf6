#include "dataset/manifest_fields.h"

#include <algorithm>
#include <sstream>

namespace taxelsim::dataset {

std::string quoted(const std::string& text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (code < 0x20 || code == 0x7f) {
      result += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string quotedList(const std::vector<std::string>& texts) {
  std::string list = "[";
  for (const std::string& text : texts) list += (list.size() > 1 ? ", " : "") + quoted(text);
  return list + "]";
}

std::string block(const std::string& text) {
  const bool fits_block = text.size() > 1 && text.front() != ' ' && text.front() != '\n' && text.back() == '\n' &&
                          text[text.size() - 2] != '\n' &&
                          std::none_of(text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; });
  if (!fits_block) return quoted(text) + "\n";
  std::string result = "|\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += line.empty() ? "\n" : "  " + line + "\n";
  return result;
}

}  // namespace taxelsim::dataset
