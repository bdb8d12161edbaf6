// Recorded tables of numbers: CSV with named columns in any order, each name with its unit. Reads the whole file, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::size_t kMaxTableNumbers = std::size_t{1} << 25;  // of one file: rows x columns; 256 MiB
inline constexpr double kMaxTableNumber = 1e15;                        // largest magnitude: clock readings in any unit

inline constexpr std::string_view kGridColumns = "r{row}_c{col}";  // default for a sensor with one grid

// A measured quantity: the allowed names of its column, each with its unit.
struct Quantity {
  struct Unit {
    std::string_view column;  // "force_mN"
    double per_si = 1;        // SI units in one of this unit
  };

  std::string_view what;  // for messages
  std::array<Unit, 3> units{};
};

inline constexpr Quantity kForce{"the force", {{{"force_N", 1}, {"force_mN", 1e-3}}}};
inline constexpr Quantity kDepth{"the depth", {{{"depth_m", 1}, {"depth_mm", 1e-3}, {"depth_um", 1e-6}}}};
inline constexpr Quantity kRecordedTime{"the time", {{{"time_s", 1}, {"time_ms", 1e-3}, {"t_s", 1}}}};
inline constexpr Quantity kPositionX{"the position along x", {{{"x_m", 1}, {"x_mm", 1e-3}}}};
inline constexpr Quantity kPositionY{"the position along y", {{{"y_m", 1}, {"y_mm", 1e-3}}}};
inline constexpr Quantity kYaw{"the turn about z", {{{"yaw_rad", 1}, {"yaw_deg", std::numbers::pi / 180}}}};
inline constexpr Quantity kPressure{"the pressure", {{{"pressure_Pa", 1}, {"pressure_kPa", 1e3}}}};
inline constexpr Quantity kPress{"the number of the press", {{{"press", 1}}}};
inline constexpr Quantity kCounts{"the output", {{{"counts", 1}}}};
inline constexpr Quantity kTaxel{"the index of the taxel in storage order", {{{"taxel", 1}}}};

class NumberTable {
 public:
  // Throws Error(kInput) with file, line and column: no such file, no heading, a name given twice, a row with another number of values than
  // the heading, a value that is not a finite number, no row, more than kMaxTableNumbers numbers.
  explicit NumberTable(const std::filesystem::path& file);

  const std::string& name() const { return name_; }
  std::size_t numRows() const { return numbers_.size() / columns_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }
  double at(std::size_t row, std::size_t column) const { return numbers_[row * columns_.size() + column]; }

  // The numbers of a quantity, SI, (rows). Throws Error(kInput) if no column or two columns have one of its names.
  std::vector<double> require(const Quantity& quantity) const;
  // The same, empty if there is no such column.
  std::vector<double> find(const Quantity& quantity) const;

  // The column of each taxel, (num_taxels), by a pattern such as "r{row}_c{col}". {row} and {col} count within the patch, {patch} is the
  // name of the patch, {taxel} the index in storage order. Numbers may have leading zeros. Throws Error(kInput) if a taxel has no column or
  // two.
  std::vector<std::size_t> taxelColumns(const Sensor& sensor, const std::string& pattern) const;

  // The same by a list of their names. Throws Error(kInput) if there is no such column.
  std::vector<std::size_t> columnsNamed(const std::vector<std::string>& names) const;

  // Index of the quantity's column, which must exist.
  std::size_t columnOf(const Quantity& quantity) const;

  // Throws Error(kInput): FILE:LINE:COLUMN: name of the column: what. Reads the file again to find the place.
  [[noreturn]] void failAtValue(std::size_t row, std::size_t column, const std::string& what) const;
  // Throws Error(kInput): FILE:LINE:1: what, at the heading.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  std::vector<std::string> columns_;
  std::size_t heading_line_ = 0;
  std::vector<double> numbers_;  // (rows x columns), as written
};

}  // namespace taxelsim
