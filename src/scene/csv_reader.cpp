#include "scene/csv_reader.h"

#include <algorithm>
#include <cmath>

#include "base/byte_order_mark.h"
#include "base/files.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string headingOf(std::span<const CsvColumn> columns) {
  std::string heading;
  for (const CsvColumn& column : columns) heading += (heading.empty() ? "" : ",") + std::string(column.name);
  return heading;
}

}  // namespace

bool isHeading(const CsvReader& reader, std::span<const CsvColumn> columns) {
  return std::equal(reader.fields().begin(), reader.fields().end(), columns.begin(), columns.end(),
                    [](const CsvReader::Field& field, const CsvColumn& column) { return field.text == column.name; });
}

CsvReader::CsvReader(const std::filesystem::path& file, std::uintmax_t max_bytes) : file_(file.generic_string()) {
  if (const std::string problem = inputFileProblem(file, max_bytes); !problem.empty()) failAt(file_, problem);
  stream_.open(file, std::ios::binary);
  if (!stream_) failAt(file_, "cannot be read");
  std::error_code error;
  buffer_.resize(std::min<std::uintmax_t>(kMaxLineBytes, std::filesystem::file_size(file, error)) + 1);
}

bool CsvReader::readLine() {
  ++line_;
  stream_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  const auto count = static_cast<std::size_t>(stream_.gcount());
  if (stream_.bad()) failAt(file_, "cannot be read");
  if (stream_.fail() && count == 0) return false;
  if (stream_.fail()) fail(1, "a line longer than " + std::to_string(kMaxLineBytes) + " bytes");
  text_ = {buffer_.data(), stream_.eof() ? count : count - 1};  // without the end of the line
  if (line_ == 1) text_ = withoutByteOrderMark(text_);
  return true;
}

bool CsvReader::next() {
  while (readLine()) {
    const std::string_view text = text_.substr(0, text_.find('#'));
    if (trimmed(text).empty()) continue;
    fields_.clear();
    end_ = text.size() + 1;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      fields_.push_back({trimmed(text.substr(begin, end - begin)), begin + 1});
      begin = end + 1;
    }
    return true;
  }
  return false;
}

double CsvReader::number(std::size_t field, const CsvColumn& column) const {
  const Field& given = fields_[field];
  double value = 0;
  if (!parseNumber(given.text, value) || value < column.min || value > column.max) {
    const std::string unit = column.unit.empty() ? "" : " " + std::string(column.unit);
    fail(given.column, std::string(column.name) + ": \"" + std::string(given.text.substr(0, kMaxShown)) +
                           "\" is not allowed: a number from " + numberText(column.min) + " to " + numberText(column.max) + unit);
  }
  return value;
}

std::uint64_t CsvReader::wholeNumber(std::size_t field, const CsvColumn& column) const {
  const double value = number(field, column);
  if (value != std::floor(value)) {
    fail(fields_[field].column,
         std::string(column.name) + ": " + numberText(value) + " is not allowed: a whole number from 0 to " + numberText(column.max));
  }
  return static_cast<std::uint64_t>(value);
}

std::vector<double> CsvReader::numbers(std::span<const CsvColumn> columns) const {
  std::vector<double> result;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c == fields_.size()) fail(end_, "missing value of " + std::string(columns[c].name) + ": a line is " + headingOf(columns));
    result.push_back(number(c, columns[c]));
  }
  if (fields_.size() > columns.size()) fail(fields_[columns.size()].column, "one value too many: a line is " + headingOf(columns));
  return result;
}

void CsvReader::fail(std::size_t column, const std::string& what) const {
  failAt(file_ + ":" + std::to_string(line_) + ":" + std::to_string(column), what);
}

std::size_t readCsvRows(const std::filesystem::path& file, const CsvFormat& format,
                        const std::function<void(std::span<const double>, const CsvReader&)>& use_row) {
  CsvReader reader(file, format.max_bytes);
  bool needs_heading = format.has_heading;
  std::size_t num_rows = 0;
  while (reader.next()) {
    if (needs_heading) {
      if (!isHeading(reader, format.columns)) reader.fail(1, "missing heading: the first line must be " + headingOf(format.columns));
      needs_heading = false;
      continue;
    }
    if (num_rows == format.max_rows) reader.fail(1, "more than " + std::to_string(format.max_rows) + " " + format.row + "s");
    use_row(reader.numbers(format.columns), reader);
    ++num_rows;
  }
  if (format.has_heading && num_rows == 0) {
    reader.fail(1, "no " + format.row + " found: the file needs the heading " + headingOf(format.columns) + " and at least one line");
  }
  return num_rows;
}

void failAt(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::kInput, oneLine(place + ": " + what));
}

}  // namespace taxelsim
