// Writes the canonical text of a scene: block YAML with every setting once, in a fixed order, in SI units, in one spelling. Not a general
// YAML emitter.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace taxelsim {

// The shortest text that parses to the same double; independent of the locale.
std::string canonicalNumber(double value);

// [1, 2.5, 3]
std::string canonicalList(std::span<const double> values);

// The text itself if every YAML reader reads it as text, else in double quotes.
std::string canonicalText(std::string_view text);

class Canonical {
 public:
  // "key: value", the value already in its canonical form.
  void line(std::string_view key, std::string_view value);

  // "key:"; following lines are below it until close().
  void open(std::string_view key);
  // An item, a mapping, of the list that was opened last.
  void openItem();
  void close();

  const std::string& text() const { return text_; }

 private:
  void indent();

  std::string text_;
  int depth_ = 0;
  bool item_ = false;  // the next line begins an item
};

}  // namespace taxelsim
