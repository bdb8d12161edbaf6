#include "scene/number_table.h"

#include <algorithm>
#include <charconv>

#include "base/text.h"
#include "scene/csv_reader.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxColumns = 1 << 15;
constexpr std::size_t kMaxShown = 60;  // bytes of a name that a message repeats

std::string shown(std::string_view text) {
  return "\"" + std::string(text.substr(0, kMaxShown)) + "\"";
}

std::string namesOf(const Quantity& quantity) {
  std::string names;
  for (const Quantity::Unit& unit : quantity.units) {
    if (!unit.column.empty()) names += (names.empty() ? "" : " or ") + std::string(unit.column);
  }
  return names;
}

std::vector<std::string> headingOf(const CsvReader& reader) {
  std::vector<std::string> names;
  for (const CsvReader::Word& word : reader.words()) {
    double number = 0;
    if (word.text.empty() || parseNumber(word.text, number)) {
      reader.fail(word.column, shown(word.text) + " is not allowed: the first line names the columns, each name ending in its unit");
    }
    if (std::find(names.begin(), names.end(), word.text) != names.end()) reader.fail(word.column, shown(word.text) + " stands twice");
    names.emplace_back(word.text);
  }
  if (names.size() > kMaxColumns)
    reader.fail(1, std::to_string(names.size()) + " columns are not allowed: at most " + std::to_string(kMaxColumns));
  return names;
}

// Whether `name` is `pattern` with this taxel's numbers in place of {row}, {col}, {taxel} and its patch's name in place of {patch}.
bool matches(std::string_view name, std::string_view pattern, const GridPatch& patch, int row, int col, int taxel) {
  while (!pattern.empty()) {
    const std::size_t close = pattern.front() == '{' ? pattern.find('}') : std::string_view::npos;
    if (close == std::string_view::npos) {
      if (name.empty() || name.front() != pattern.front()) return false;
      name.remove_prefix(1);
      pattern.remove_prefix(1);
      continue;
    }
    const std::string_view key = pattern.substr(1, close - 1);
    pattern.remove_prefix(close + 1);
    if (key == "patch") {
      if (!name.starts_with(patch.name)) return false;
      name.remove_prefix(patch.name.size());
      continue;
    }
    int number = -1;
    const std::from_chars_result result = std::from_chars(name.data(), name.data() + name.size(), number);
    if (result.ec != std::errc() || number != (key == "row" ? row : key == "col" ? col : taxel)) return false;
    name.remove_prefix(static_cast<std::size_t>(result.ptr - name.data()));
  }
  return name.empty();
}

}  // namespace

NumberTable::NumberTable(const std::filesystem::path& file) {
  CsvReader reader(file);
  name_ = reader.file();
  std::size_t expected_line = 0;
  while (reader.next()) {
    if (columns_.empty()) {
      columns_ = headingOf(reader);
      heading_line_ = reader.line();
      expected_line = heading_line_ + 1;
      continue;
    }
    if (reader.words().size() < columns_.size()) {
      reader.fail(reader.end(),
                  std::to_string(reader.words().size()) + " values found, the heading names " + std::to_string(columns_.size()));
    }
    if (reader.words().size() > columns_.size()) {
      reader.fail(reader.words()[columns_.size()].column, "a value more than the heading's " + std::to_string(columns_.size()) + " names");
    }
    if (numbers_.size() + columns_.size() > kMaxTableNumbers) {
      reader.fail(1, "more than " + std::to_string(kMaxTableNumbers) + " numbers: give every second or tenth row, or fewer columns");
    }
    for (; expected_line < reader.line(); ++expected_line) gaps_.push_back(numRows());
    ++expected_line;
    for (std::size_t c = 0; c < columns_.size(); ++c) numbers_.push_back(reader.number(c, columns_[c], kMaxTableNumber));
  }
  if (numbers_.empty()) reader.fail(1, "no row: a line that names the columns, then at least one line of numbers");
}

std::vector<double> NumberTable::require(const Quantity& quantity) const {
  std::vector<double> values = find(quantity);
  if (values.empty()) fail("no column has " + std::string(quantity.what) + ": " + namesOf(quantity));
  return values;
}

std::vector<double> NumberTable::find(const Quantity& quantity) const {
  std::vector<double> values;
  std::string_view taken;
  for (const Quantity::Unit& unit : quantity.units) {
    const auto column = unit.column.empty() ? columns_.end() : std::find(columns_.begin(), columns_.end(), unit.column);
    if (column == columns_.end()) continue;
    if (!taken.empty()) fail(std::string(taken) + " and " + *column + " both stand here: one of the two");
    taken = *column;
    const auto c = static_cast<std::size_t>(column - columns_.begin());
    values.reserve(numRows());
    for (std::size_t row = 0; row < numRows(); ++row) values.push_back(at(row, c) * unit.per_si);
  }
  return values;
}

std::vector<std::size_t> NumberTable::taxelColumns(const Sensor& sensor, const std::string& pattern) const {
  std::vector<std::size_t> result;
  int taxel = 0;
  for (const GridPatch& patch : sensor.patches) {
    for (int row = 0; row < patch.num_rows; ++row) {
      for (int col = 0; col < patch.num_cols; ++col, ++taxel) {
        std::size_t found = columns_.size();
        for (std::size_t c = 0; c < columns_.size(); ++c) {
          if (!matches(columns_[c], pattern, patch, row, col, taxel)) continue;
          if (found != columns_.size()) {
            fail(shown(columns_[found]) + " and " + shown(columns_[c]) + " both are taxel " + std::to_string(taxel) + " by the pattern " +
                 shown(pattern));
          }
          found = c;
        }
        if (found == columns_.size()) {
          fail("no column is taxel " + std::to_string(taxel) + " (row " + std::to_string(row) + ", col " + std::to_string(col) +
               " of patch " + shown(patch.name) + ") by the pattern " + shown(pattern));
        }
        result.push_back(found);
      }
    }
  }
  return result;
}

void NumberTable::failAtRow(std::size_t row, const std::string& what) const {
  const auto skipped = std::upper_bound(gaps_.begin(), gaps_.end(), row) - gaps_.begin();
  failAt(name_ + ":" + std::to_string(heading_line_ + 1 + row + static_cast<std::size_t>(skipped)), what);
}

void NumberTable::fail(const std::string& what) const {
  failAt(name_ + ":" + std::to_string(heading_line_), what);
}

}  // namespace taxelsim
