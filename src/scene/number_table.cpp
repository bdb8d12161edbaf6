#include "scene/number_table.h"

#include <algorithm>
#include <charconv>

#include "base/text.h"
#include "scene/csv_reader.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxColumns = 1 << 15;

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
  for (const CsvReader::Field& field : reader.fields()) {
    double number = 0;
    if (field.text.empty() || parseNumber(field.text, number)) {
      reader.fail(field.column, shown(field.text) + " is not allowed: the first line must name the columns, with units, such as force_N");
    }
    if (std::find(names.begin(), names.end(), field.text) != names.end()) reader.fail(field.column, shown(field.text) + " is given twice");
    names.emplace_back(field.text);
  }
  if (names.size() > kMaxColumns)
    reader.fail(1, std::to_string(names.size()) + " columns are not allowed: at most " + std::to_string(kMaxColumns));
  return names;
}

// True if `name` is `pattern` with {row}, {col}, {taxel} and {patch} replaced by those of this taxel.
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
  while (reader.next()) {
    if (columns_.empty()) {
      columns_ = headingOf(reader);
      heading_line_ = reader.line();
      continue;
    }
    if (reader.fields().size() < columns_.size()) {
      reader.fail(reader.fields().back().column, std::to_string(reader.fields().size()) + " values are not allowed: the heading has " +
                                                     std::to_string(columns_.size()) + " names");
    }
    if (reader.fields().size() > columns_.size()) {
      reader.fail(reader.fields()[columns_.size()].column,
                  "one value too many: the heading has " + std::to_string(columns_.size()) + " names");
    }
    if (numbers_.size() + columns_.size() > kMaxTableNumbers) {
      reader.fail(1, "more than " + std::to_string(kMaxTableNumbers) + " numbers: subsample the rows or remove columns");
    }
    for (std::size_t c = 0; c < columns_.size(); ++c)
      numbers_.push_back(reader.number(c, {columns_[c], -kMaxTableNumber, kMaxTableNumber}));
  }
  if (numbers_.empty())
    reader.fail(1, "no row found: the table needs a heading with the names of the columns and at least one line of numbers");
}

std::vector<double> NumberTable::require(const Quantity& quantity) const {
  std::vector<double> values = find(quantity);
  if (values.empty()) fail("missing column of " + std::string(quantity.what) + ": " + namesOf(quantity));
  return values;
}

std::vector<double> NumberTable::find(const Quantity& quantity) const {
  std::vector<double> values;
  std::string_view taken;
  for (const Quantity::Unit& unit : quantity.units) {
    const auto column = unit.column.empty() ? columns_.end() : std::find(columns_.begin(), columns_.end(), unit.column);
    if (column == columns_.end()) continue;
    if (!taken.empty()) fail(std::string(taken) + " and " + *column + " are both given: only one is allowed");
    taken = *column;
    const auto c = static_cast<std::size_t>(column - columns_.begin());
    values.reserve(numRows());
    for (std::size_t row = 0; row < numRows(); ++row) values.push_back(at(row, c) * unit.per_si);
  }
  return values;
}

std::size_t NumberTable::columnOf(const Quantity& quantity) const {
  const auto column = std::find_if(columns_.begin(), columns_.end(), [&](const std::string& name) {
    return std::any_of(quantity.units.begin(), quantity.units.end(), [&](const Quantity::Unit& unit) { return unit.column == name; });
  });
  return static_cast<std::size_t>(column - columns_.begin());
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
            fail(shown(columns_[found]) + " and " + shown(columns_[c]) + " both match taxel " + std::to_string(taxel) + " by the pattern " +
                 shown(pattern));
          }
          found = c;
        }
        if (found == columns_.size()) {
          fail("missing column of taxel " + std::to_string(taxel) + " (row " + std::to_string(row) + ", col " + std::to_string(col) +
               " of patch " + shown(patch.name) + ") by the pattern " + shown(pattern));
        }
        result.push_back(found);
      }
    }
  }
  return result;
}

std::vector<std::size_t> NumberTable::columnsNamed(const std::vector<std::string>& names) const {
  std::vector<std::size_t> result;
  for (const std::string& name : names) {
    const auto column = std::find(columns_.begin(), columns_.end(), name);
    if (column == columns_.end()) fail("missing column " + shown(name) + " of taxel " + std::to_string(result.size()));
    result.push_back(static_cast<std::size_t>(column - columns_.begin()));
  }
  return result;
}

void NumberTable::failAtValue(std::size_t row, std::size_t column, const std::string& what) const {
  CsvReader reader(name_);
  for (std::size_t r = 0; r <= row + 1; ++r) reader.next();  // the heading is the first
  reader.fail(reader.fields()[column].column, columns_[column] + ": " + what);
}

void NumberTable::fail(const std::string& what) const {
  failAt(name_ + ":" + std::to_string(heading_line_) + ":1", what);
}

}  // namespace taxelsim
