// Values of a PLY file, one after the other, in text or binary.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "geometry/number_type.h"

namespace taxelsim {

enum class PlyEncoding { kText, kLittle, kBig };

struct PlyProblem {
  std::string text;  // a sentence about the file
};

std::optional<NumberType> plyType(std::string_view name);

// Words between blanks; empty at the end.
class PlyWords {
 public:
  explicit PlyWords(std::string_view text) : text_(text) {}
  std::string_view next();
  std::size_t numBytesLeft() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

class PlyBody {
 public:
  PlyBody(std::string_view bytes, PlyEncoding encoding) : bytes_(bytes), words_(bytes), encoding_(encoding) {}

  // Throws PlyProblem at the end of the file, and for a word that is not a finite number.
  double read(NumberType type);

  // Throws PlyProblem if the rest of the file cannot hold `count` rows of values of these types.
  void expectRows(std::uint64_t count, std::span<const NumberType> types) const;

  // The number of values of a list. Throws PlyProblem as well if that many do not fit into the rest of the file.
  std::uint64_t readCount(NumberType count_type, NumberType value_type);

 private:
  std::string_view bytes_;  // binary: those left
  PlyWords words_;          // text
  PlyEncoding encoding_;
};

}  // namespace taxelsim
