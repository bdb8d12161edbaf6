#include "scene/csv_rows.h"

#include "scene/csv_reader.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxRows = 1'000'000;

std::string headingOf(std::span<const CsvColumn> columns) {
  std::string heading;
  for (const CsvColumn& column : columns) heading += (heading.empty() ? "" : ",") + std::string(column.name);
  return heading;
}

bool isHeading(const CsvReader& reader, std::span<const CsvColumn> columns) {
  if (reader.words().size() != columns.size()) return false;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (reader.words()[c].text != columns[c].name) return false;
  }
  return true;
}

std::vector<double> numbersOf(const CsvReader& reader, std::span<const CsvColumn> columns) {
  const std::vector<CsvReader::Word>& words = reader.words();
  std::vector<double> numbers;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c == words.size()) reader.fail(reader.end(), std::string(columns[c].name) + " is missing: " + headingOf(columns));
    numbers.push_back(reader.number(c, columns[c].name, columns[c].largest));
  }
  if (words.size() > columns.size()) reader.fail(words[columns.size()].column, "a value more than " + headingOf(columns));
  return numbers;
}

}  // namespace

void CsvRow::fail(const std::string& what) const {
  failAt(place + ":1", what);
}

std::vector<CsvRow> readCsv(const std::filesystem::path& file, std::span<const CsvColumn> columns, const std::string& what) {
  CsvReader reader(file);
  const std::string heading = headingOf(columns);
  std::vector<CsvRow> rows;
  bool has_heading = false;
  while (reader.next()) {
    if (!has_heading) {
      if (!isHeading(reader, columns)) reader.fail(1, "the heading is missing: " + heading);
      has_heading = true;
      continue;
    }
    if (rows.size() == kMaxRows) reader.fail(1, "more than " + std::to_string(kMaxRows) + " " + what + "s");
    rows.push_back({numbersOf(reader, columns), reader.place()});
  }
  if (rows.empty()) reader.fail(1, "no " + what + ": " + heading + ", then at least one line");
  return rows;
}

}  // namespace taxelsim
