#include "scene/csv_reader.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxShown = 40;  // bytes of a value that a message repeats
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file) : file_(file.generic_string()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) failAt(file_, "is not there, or not a file");
  stream_.open(file, std::ios::binary);
  if (!stream_) failAt(file_, "cannot be read");
}

bool CsvReader::next() {
  while (++line_, std::getline(stream_, text_)) {
    const std::string_view text = std::string_view(text_).substr(0, text_.find('#'));
    if (trimmed(text).empty()) continue;
    words_.clear();
    end_ = text.size() + 1;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      words_.push_back({trimmed(text.substr(begin, end - begin)), begin + 1});
      begin = end + 1;
    }
    return true;
  }
  return false;
}

double CsvReader::number(std::size_t word, std::string_view name, double largest) const {
  const Word& given = words_[word];
  double value = 0;
  if (!parseNumber(given.text, value) || std::abs(value) > largest) {
    fail(given.column, std::string(name) + ": \"" + std::string(given.text.substr(0, kMaxShown)) + "\" is not allowed: a number from -" +
                           numberText(largest) + " to " + numberText(largest));
  }
  return value;
}

void CsvReader::fail(std::size_t column, const std::string& what) const {
  failAt(place() + ":" + std::to_string(column), what);
}

void failAt(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::kInput, oneLine(place + ": " + what));
}

}  // namespace taxelsim
