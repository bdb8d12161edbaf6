// Tables of numbers as people record them: CSV with named columns in any order, each name ending in its unit. `#` begins a comment. Read
// whole, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::size_t kMaxTableNumbers = std::size_t{1} << 25;  // of one file: rows x columns; 256 MiB
inline constexpr double kMaxTableNumber = 1e15;                        // size of a number: those of clocks, in any unit

inline constexpr std::string_view kGridColumns = "r{row}_c{col}";  // columns of a sensor that is one grid, unless told otherwise

// A quantity that measurements have: the names that a column of it may have, each with the SI units in one of its own.
struct Quantity {
  struct Unit {
    std::string_view column;  // "force_mN"
    double per_si = 1;
  };

  std::string_view what;  // for messages
  std::array<Unit, 3> units{};
};

inline constexpr Quantity kForce{"a force", {{{"force_N", 1}, {"force_mN", 1e-3}}}};
inline constexpr Quantity kDepth{"a depth", {{{"depth_m", 1}, {"depth_mm", 1e-3}, {"depth_um", 1e-6}}}};
inline constexpr Quantity kTime{"a time", {{{"time_s", 1}, {"time_ms", 1e-3}}}};
inline constexpr Quantity kPositionX{"a place along x", {{{"x_m", 1}, {"x_mm", 1e-3}}}};
inline constexpr Quantity kPositionY{"a place along y", {{{"y_m", 1}, {"y_mm", 1e-3}}}};
inline constexpr Quantity kCounts{"an output", {{{"counts", 1}}}};
inline constexpr Quantity kTaxel{"a taxel's index in storage order", {{{"taxel", 1}}}};

class NumberTable {
 public:
  // Throws Error(kInput), one line with file, line and column: no such file, no heading, a name given twice, a row with fewer or more
  // values than the heading has names, a value that is no finite number, no row, more than kMaxTableNumbers numbers.
  explicit NumberTable(const std::filesystem::path& file);

  const std::string& name() const { return name_; }
  std::size_t numRows() const { return numbers_.size() / columns_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }
  double at(std::size_t row, std::size_t column) const { return numbers_[row * columns_.size() + column]; }

  // The numbers of a quantity, SI, (rows). Throws Error(kInput) when no column has one of its names, or two have.
  std::vector<double> require(const Quantity& quantity) const;
  // The same, empty when there is none.
  std::vector<double> find(const Quantity& quantity) const;

  // Which column holds which taxel, (num_taxels), by a pattern such as "r{row}_c{col}": {row} and {col} of a taxel in its patch, {patch}
  // the patch's name, {taxel} the index in storage order. Numbers of a column's name may have leading zeros. Throws Error(kInput) when a
  // taxel has no column, or two.
  std::vector<std::size_t> taxelColumns(const Sensor& sensor, const std::string& pattern) const;

  // Throws Error(kInput): FILE:LINE: what, of a row from 0 on; of the table as a whole the line of its heading.
  [[noreturn]] void failAtRow(std::size_t row, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  std::vector<std::string> columns_;
  std::size_t heading_line_ = 0;
  std::vector<double> numbers_;    // (rows x columns), as written
  std::vector<std::size_t> gaps_;  // rows before which lines were skipped, one entry a line, ascending
};

}  // namespace taxelsim
