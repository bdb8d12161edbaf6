// Writes the canonical form of a scene: block YAML in which every setting stands once, in one order, in SI units, in one spelling. Not a
// general YAML emitter.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace taxelsim {

// The shortest text that reads back as the same double, whatever the locale.
std::string canonicalNumber(double value);

// [1, 2.5, 3]
std::string canonicalList(std::span<const double> values);

// The text itself where every YAML reader takes it for text, else in double quotes.
std::string canonicalText(std::string_view text);

class Canonical {
 public:
  // "key: value", the value already in its canonical form.
  void line(std::string_view key, std::string_view value);

  // "key:", and what follows stands below it until close().
  void open(std::string_view key);
  // An item, which is a mapping, of the list just opened.
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
