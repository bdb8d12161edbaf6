#include "scene/canonical.h"

#include <algorithm>
#include <array>

#include "base/text.h"

namespace taxelsim {
namespace {

// Words that YAML 1.1 or 1.2 readers do not read as text.
constexpr std::array<std::string_view, 10> kReserved = {"y", "n", "yes", "no", "on", "off", "true", "false", "null", "inf"};

bool isPlain(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto inside = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.'; };
  if (text.empty() || !letter(text.front()) || !std::all_of(text.begin(), text.end(), inside)) return false;
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return std::find(kReserved.begin(), kReserved.end(), lower) == kReserved.end();
}

}  // namespace

std::string canonicalNumber(double value) {
  return numberText(value);
}

std::string canonicalList(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) {
    if (text.size() > 1) text += ", ";
    text += canonicalNumber(value);
  }
  return text + "]";
}

std::string canonicalText(std::string_view text) {
  if (isPlain(text)) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

void Canonical::line(std::string_view key, std::string_view value) {
  indent();
  text_.append(key).append(": ").append(value).append("\n");
}

void Canonical::open(std::string_view key) {
  indent();
  text_.append(key).append(":\n");
  ++depth_;
}

void Canonical::openItem() {
  ++depth_;
  item_ = true;
}

void Canonical::close() {
  --depth_;
  item_ = false;
}

void Canonical::indent() {
  text_.append(static_cast<std::size_t>(2 * (item_ ? depth_ - 1 : depth_)), ' ');
  if (item_) text_ += "- ";
  item_ = false;
}

}  // namespace taxelsim
