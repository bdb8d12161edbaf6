// Tables of numbers as text: a heading that must be as it is asked for, then lines of as many numbers. `#` begins a comment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taxelsim {

struct CsvColumn {
  std::string_view name;
  double largest;  // size of a number
};

// One line, and where it stands for messages.
struct CsvRow {
  std::vector<double> numbers;  // (columns)
  std::string place;            // FILE:LINE

  // Throws Error(kInput).
  [[noreturn]] void fail(const std::string& what) const;
};

// `what`: a row, for messages. Throws Error(kInput): file, line, column, the value found and what is allowed; also for a file without rows
// and for more than a million.
std::vector<CsvRow> readCsv(const std::filesystem::path& file, std::span<const CsvColumn> columns, const std::string& what);

}  // namespace taxelsim
