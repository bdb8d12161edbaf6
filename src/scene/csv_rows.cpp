#include "scene/csv_rows.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxRows = 1'000'000;
constexpr std::size_t kMaxShown = 40;  // bytes of a value that a message repeats
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

[[noreturn]] void failAt(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::kInput, oneLine(place + ": " + what));
}

std::string headingOf(std::span<const CsvColumn> columns) {
  std::string heading;
  for (const CsvColumn& column : columns) heading += (heading.empty() ? "" : ",") + std::string(column.name);
  return heading;
}

// As written, but for blanks around the commas.
bool isHeading(std::string_view text, const std::string& heading) {
  std::string bare;
  for (const char c : text) {
    if (kBlanks.find(c) == std::string_view::npos) bare += c;
  }
  return bare == heading;
}

std::vector<double> numbersOf(std::string_view text, const std::string& place, std::span<const CsvColumn> columns) {
  // `begin` counts bytes from 0.
  const auto fail = [&](std::size_t begin, const std::string& what) { failAt(place + ":" + std::to_string(begin + 1), what); };
  std::vector<double> numbers(columns.size());
  std::size_t begin = 0;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto& [name, largest] = columns[c];
    if (begin > text.size()) fail(text.size(), std::string(name) + " is missing: " + headingOf(columns));
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = trimmed(text.substr(begin, end - begin));
    if (!parseNumber(word, numbers[c]) || std::abs(numbers[c]) > largest) {
      fail(begin, std::string(name) + ": \"" + std::string(word.substr(0, kMaxShown)) + "\" is not allowed: a number from -" +
                      numberText(largest) + " to " + numberText(largest));
    }
    begin = end + 1;
  }
  if (begin <= text.size()) fail(begin, "a value more than " + headingOf(columns));
  return numbers;
}

}  // namespace

void CsvRow::fail(const std::string& what) const {
  failAt(place + ":1", what);
}

std::vector<CsvRow> readCsv(const std::filesystem::path& file, std::span<const CsvColumn> columns, const std::string& what) {
  const std::string name = file.generic_string(), heading = headingOf(columns);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) failAt(name, "is not there, or not a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) failAt(name, "cannot be read");

  std::vector<CsvRow> rows;
  bool has_heading = false;
  std::string line;
  std::size_t number = 0;
  while (std::getline(stream, line)) {
    const std::string_view text = std::string_view(line).substr(0, line.find('#'));
    const std::string place = name + ":" + std::to_string(++number);
    if (trimmed(text).empty()) continue;
    if (!has_heading) {
      if (!isHeading(text, heading)) failAt(place + ":1", "the heading is missing: " + heading);
      has_heading = true;
      continue;
    }
    if (rows.size() == kMaxRows) failAt(place + ":1", "more than " + std::to_string(kMaxRows) + " " + what + "s");
    rows.push_back({numbersOf(text, place, columns), place});
  }
  if (rows.empty()) failAt(name + ":" + std::to_string(number + 1) + ":1", "no " + what + ": " + heading + ", then at least one line");
  return rows;
}

}  // namespace taxelsim
