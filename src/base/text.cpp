#include "base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

namespace taxelsim {
namespace {

std::string escape(char byte) {
  constexpr const char* kDigits = "0123456789abcdef";
  const auto code = static_cast<unsigned char>(byte);
  return {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
}

// `character`: a UTF-8 sequence, or one byte that is none.
bool isPrintable(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(character[i])); };
  if (character.size() == 1) return character[0] == '\n' || (byte(0) >= 0x20 && byte(0) < 0x7f);
  if (character.size() == 2) return byte(0) != 0xC2 || byte(1) >= 0xA0;  // C1: U+0080 to U+009F
  if (character.size() != 3 || byte(0) != 0xE2) return true;
  const unsigned code = (byte(1) & 0x3Fu) << 6 | (byte(2) & 0x3Fu);  // of U+2000 to U+2FFF
  const bool is_separator = code == 0x028 || code == 0x029;          // U+2028 and U+2029
  const bool is_direction = code == 0x00E || code == 0x00F || (code >= 0x02A && code <= 0x02E) || (code >= 0x066 && code <= 0x069);
  return !is_separator && !is_direction;
}

}  // namespace

std::string numberText(double value) {
  std::array<char, 32> buffer;
  const std::to_chars_result result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

std::size_t utf8Length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const auto continues = [&](std::size_t k) { return (byte(k) & 0xC0u) == 0x80u; };
  const unsigned first = byte(i);
  if (first < 0x80u) return 1;
  if (first >= 0xC2u && first <= 0xDFu) return continues(i + 1) ? 2 : 0;
  if (first >= 0xE0u && first <= 0xEFu) {
    const bool overlong = first == 0xE0u && byte(i + 1) < 0xA0u;
    const bool surrogate = first == 0xEDu && byte(i + 1) > 0x9Fu;
    return continues(i + 1) && continues(i + 2) && !overlong && !surrogate ? 3 : 0;
  }
  if (first >= 0xF0u && first <= 0xF4u) {
    const bool overlong = first == 0xF0u && byte(i + 1) < 0x90u;
    const bool beyond = first == 0xF4u && byte(i + 1) > 0x8Fu;
    return continues(i + 1) && continues(i + 2) && continues(i + 3) && !overlong && !beyond ? 4 : 0;
  }
  return 0;
}

std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = std::max<std::size_t>(1, utf8Length(text, i));
    const std::string_view character = text.substr(i, length);
    if (isPrintable(character)) {
      result += character;
    } else {
      for (const char byte : character) result += escape(byte);
    }
    i += length;
  }
  return result;
}

std::string oneLine(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return printable(line);
}

std::string messageLine(std::string_view text) {
  constexpr std::size_t kStart = 280;  // bytes
  constexpr std::string_view kGap = " ... ";
  const std::string line = oneLine(text);
  if (line.size() <= kMaxMessageBytes) return line;
  std::size_t end = kStart;
  std::size_t rest = line.size() - (kMaxMessageBytes - kStart - kGap.size());
  const auto continues = [&](std::size_t i) { return (static_cast<unsigned char>(line[i]) & 0xC0u) == 0x80u; };
  while (continues(end)) --end;
  while (rest < line.size() && continues(rest)) ++rest;
  return line.substr(0, end).append(kGap).append(line, rest);
}

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

bool parseNumber(std::string_view text, double& value) {
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end && std::isfinite(value);
}

}  // namespace taxelsim
