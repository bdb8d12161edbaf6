// Comma-separated text, a line at a time: blanks around values are dropped, `#` begins a comment, lines without anything else are skipped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace taxelsim {

class CsvReader {
 public:
  struct Word {
    std::string_view text;   // as long as the reader stays at this line
    std::size_t column = 1;  // byte where its field begins, from 1
  };

  // Throws Error(kInput) where there is no such file.
  explicit CsvReader(const std::filesystem::path& file);

  // On to the next line that holds anything; false at the end.
  bool next();

  const std::string& file() const { return file_; }
  std::size_t line() const { return line_; }  // from 1; at the end one more than there are
  const std::vector<Word>& words() const { return words_; }
  std::size_t end() const { return end_; }                                   // column after the line's last byte
  std::string place() const { return file_ + ":" + std::to_string(line_); }  // FILE:LINE

  // A finite number of size `largest` or less; else throws Error(kInput): FILE:LINE:COLUMN: `name`: what was found, what is allowed.
  double number(std::size_t word, std::string_view name, double largest) const;

  // Throws Error(kInput): FILE:LINE:COLUMN: what.
  [[noreturn]] void fail(std::size_t column, const std::string& what) const;

 private:
  std::string file_;
  std::ifstream stream_;
  std::string text_;
  std::size_t line_ = 0;
  std::size_t end_ = 1;
  std::vector<Word> words_;
};

// Throws Error(kInput) with a text of one line.
[[noreturn]] void failAt(const std::string& place, const std::string& what);

}  // namespace taxelsim
