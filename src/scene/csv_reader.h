// Reads comma-separated values line by line, in bounded memory. Blanks around values are trimmed, `#` begins a comment, empty lines are
// skipped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taxelsim {

struct CsvColumn {
  std::string_view name;
  double min = 0, max = 0;
  std::string_view unit{};  // for messages
};

class CsvReader {
 public:
  struct Field {
    std::string_view text;   // valid until next()
    std::size_t column = 1;  // byte position in the line, from 1
  };

  static constexpr std::size_t kMaxLineBytes = std::size_t{4} << 20;

  // Throws Error(kInput) if the file does not exist or is larger than `max_bytes`.
  explicit CsvReader(const std::filesystem::path& file, std::uintmax_t max_bytes = std::numeric_limits<std::uintmax_t>::max());

  // Advances to the next line with values; false at the end of the file. Throws Error(kInput) for a line longer than kMaxLineBytes.
  bool next();

  const std::string& file() const { return file_; }
  std::size_t line() const { return line_; }  // from 1; after the last line, the number of lines + 1
  const std::vector<Field>& fields() const { return fields_; }

  // The field as a finite number within the column's range; otherwise throws as fail() does, with the value found and the range allowed.
  double number(std::size_t field, const CsvColumn& column) const;
  // The same for a column of whole numbers from 0 on.
  std::uint64_t wholeNumber(std::size_t field, const CsvColumn& column) const;
  // One number for each column; throws if the line has more or fewer fields.
  std::vector<double> numbers(std::span<const CsvColumn> columns) const;

  // Throws Error(kInput): FILE:LINE:COLUMN: what.
  [[noreturn]] void fail(std::size_t column, const std::string& what) const;

 private:
  bool readLine();

  std::string file_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::string_view text_;  // of the line, in buffer_
  std::size_t line_ = 0;
  std::size_t end_ = 1;  // column after the last byte of the line
  std::vector<Field> fields_;
};

// A file with a fixed list of columns.
struct CsvFormat {
  std::span<const CsvColumn> columns;
  std::string row;          // what a row is, for messages: "waypoint"
  bool has_heading = true;  // the first line must be the names of the columns
  std::size_t max_rows = 1'000'000;
  std::uintmax_t max_bytes = std::numeric_limits<std::uintmax_t>::max();
};

// Calls use_row(numbers (columns), reader) for each row; returns the number of rows. Throws Error(kInput) for a wrong heading, a value that
// is not allowed, or too many rows.
std::size_t readCsvRows(const std::filesystem::path& file, const CsvFormat& format,
                        const std::function<void(std::span<const double> numbers, const CsvReader& at)>& use_row);

// Throws Error(kInput) with a text of one line.
[[noreturn]] void failAt(const std::string& place, const std::string& what);

// Whether the fields of the line are the names of the columns.
bool isHeading(const CsvReader& reader, std::span<const CsvColumn> columns);

}  // namespace taxelsim
