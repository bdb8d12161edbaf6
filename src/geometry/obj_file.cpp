#include "geometry/obj_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/byte_order_mark.h"
#include "base/text.h"
#include "geometry/triangulate.h"

namespace taxelsim {
namespace {

std::string shown(std::string_view word) {
  return oneLine(word).substr(0, kMaxShown);
}

// A number that parseNumber() accepts. Rounds as Assimp 5.2 does, which read OBJ in versions before: whole part and decimals each to float,
// then their sum, then its product with the power of ten. A number rounded once would change vertices, and data sets with them.
float coordinateOf(std::string_view word) {
  const std::size_t end = std::min(word.find_first_of("eE"), word.size());
  double digits = 0;
  parseNumber(word.substr(0, end), digits);
  const double whole = std::trunc(digits);
  const float value = static_cast<float>(whole) + static_cast<float>(digits - whole);
  if (end == word.size()) return value;
  double exponent = 0;
  parseNumber(word.substr(end + (word[end + 1] == '+' ? 2 : 1)), exponent);
  return value * std::pow(10.0f, static_cast<float>(exponent));
}

class ObjReader {
 public:
  explicit ObjReader(Mesh& mesh) : mesh_(mesh) {}

  std::string read(std::string_view text) {
    std::string joined;  // a statement that continues on the next line, marked by a backslash at the end
    for (std::size_t number = 1; !text.empty(); ++number) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).append(" ");
        if (!text.empty()) continue;
        line = {};
      }
      if (!joined.empty()) line = joined.append(line);
      words_ = line;
      const std::string_view keyword = next();
      const std::string problem = keyword == "v" ? readVertex() : keyword == "f" ? readFace(number) : std::string();
      if (!problem.empty()) return "line " + std::to_string(number) + ": " + problem;
      joined.clear();
    }
    return addFaces();
  }

 private:
  struct Face {
    std::uint32_t num_corners = 0;
    std::size_t line = 0;
  };

  std::string_view next() {
    constexpr const char* kBlanks = " \t\r\v\f";
    words_.remove_prefix(std::min(words_.find_first_not_of(kBlanks), words_.size()));
    const std::string_view word = words_.substr(0, words_.find_first_of(kBlanks));
    words_.remove_prefix(word.size());
    return word;
  }

  std::string readVertex() {
    const std::string name = "vertex " + std::to_string(mesh_.vertices.size());
    std::array<float, 3> vertex;
    for (float& coordinate : vertex) {
      const std::string_view word = next();
      const std::string_view number = word.substr(word.starts_with('+') ? 1 : 0);
      double value = 0;
      if (word.empty()) return name + " lacks a coordinate";
      if (!parseNumber(number, value) || std::abs(value) > std::numeric_limits<float>::max())
        return name + " has the coordinate " + shown(word) + ", which is not a finite number";
      coordinate = coordinateOf(number);
    }
    const std::string_view weight = next();  // or the first of three numbers of a colour
    double value = 0;
    if (!weight.empty() && next().empty() && (!parseNumber(weight, value) || value != 1))
      return name + " has the weight " + shown(weight) + "; only 1 is allowed";
    mesh_.vertices.push_back(vertex);
    return {};
  }

  // Corners are "vertex", "vertex/texture", "vertex//normal" or "vertex/texture/normal"; numbers from 1, or from -1 back from the last
  // vertex.
  std::string readFace(std::size_t line) {
    Face face{.line = line};
    for (std::string_view word = next(); !word.empty(); word = next()) {
      std::int64_t number = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      const std::string_view rest(end, static_cast<std::size_t>(word.data() + word.size() - end));
      const bool is_corner =
          error == std::errc() && (rest.empty() || rest[0] == '/') && rest.find_first_not_of("/-0123456789") == rest.npos;
      const auto num_vertices = static_cast<std::int64_t>(mesh_.vertices.size());
      if (number < 0) number += num_vertices + 1;
      if (!is_corner || number < 1 || number > std::numeric_limits<std::uint32_t>::max())
        return "a face has the corner " + shown(word) + ", which is not a vertex";
      corners_.push_back(static_cast<std::uint32_t>(number - 1));
      if (++face.num_corners > kMaxPolygonCorners)
        return "a face has more than " + std::to_string(kMaxPolygonCorners) + " corners, which are allowed";
    }
    faces_.push_back(face);
    return {};
  }

  // At the end, because a face may use vertices that follow.
  std::string addFaces() {
    Triangulator triangulate;
    std::span<const std::uint32_t> left(corners_);
    for (const Face& face : faces_) {
      const std::span<const std::uint32_t> corners = left.first(face.num_corners);
      left = left.subspan(face.num_corners);
      for (const std::uint32_t corner : corners) {
        if (corner >= mesh_.vertices.size())
          return "line " + std::to_string(face.line) + ": a face uses vertex " + std::to_string(std::uint64_t{corner} + 1) + " of " +
                 std::to_string(mesh_.vertices.size());
      }
      if (!triangulate(mesh_.vertices, corners, mesh_.triangles)) return "its polygons take too long to triangulate";
    }
    return {};
  }

  Mesh& mesh_;
  std::string_view words_;  // of the statement, that are left
  std::vector<std::uint32_t> corners_;
  std::vector<Face> faces_;
};

}  // namespace

std::string readObj(std::string_view text, Mesh& mesh) {
  return ObjReader(mesh).read(withoutByteOrderMark(text));
}

}  // namespace taxelsim
