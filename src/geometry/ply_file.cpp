#include "geometry/ply_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "base/byte_order_mark.h"
#include "base/text.h"
#include "geometry/ply_body.h"
#include "geometry/triangulate.h"

namespace taxelsim {
namespace {

struct Property {
  std::string name;
  NumberType type{};                       // of a value
  std::optional<NumberType> count_type{};  // of the number of values of a list; none for a scalar
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<Element> elements;
  std::size_t num_bytes = 0;
};

NumberType typeOf(std::string_view name, const std::string& line) {
  if (const std::optional<NumberType> type = plyType(name)) return *type;
  throw PlyProblem{"its PLY header has a bad line: " + oneLine(line)};
}

Property propertyOf(PlyWords& words, const std::string& line) {
  Property property;
  std::string_view word = words.next();
  if (word == "list") {
    property.count_type = typeOf(words.next(), line);
    if (isFloat(*property.count_type)) throw PlyProblem{"its PLY header has a bad line: " + oneLine(line)};
    word = words.next();
  }
  property.type = typeOf(word, line);
  property.name = words.next();
  return property;
}

Element elementOf(PlyWords& words, std::size_t max_count, const std::string& line) {
  Element element{.name = std::string(words.next()), .count = 0, .properties = {}};
  const std::string_view count = words.next();
  const auto result = std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (result.ec != std::errc() || result.ptr != count.data() + count.size())
    throw PlyProblem{"its PLY header has a bad line: " + oneLine(line)};
  if (element.count > max_count)
    throw PlyProblem{"its header claims " + std::string(count) + " x " + oneLine(element.name) + ", more than the file has bytes (" +
                     std::to_string(max_count) + ")"};
  return element;
}

PlyEncoding encodingOf(std::string_view word, const std::string& line) {
  if (word == "ascii") return PlyEncoding::kText;
  if (word == "binary_little_endian") return PlyEncoding::kLittle;
  if (word == "binary_big_endian") return PlyEncoding::kBig;
  throw PlyProblem{"its PLY header has a bad line: " + oneLine(line)};
}

Header readHeader(std::string_view bytes) {
  Header header;
  bool has_format = false;
  for (std::size_t number = 0; true; ++number) {
    const std::size_t end = bytes.find('\n', header.num_bytes);
    if (end == std::string_view::npos) throw PlyProblem{"its PLY header has no end"};
    const std::string line(bytes.substr(header.num_bytes, end - header.num_bytes));
    header.num_bytes = end + 1;
    PlyWords words(line);
    const std::string_view word = words.next();
    if (number == 0 && word != "ply") throw PlyProblem{"it does not begin with ply"};
    if (word == "end_header") break;
    if (word == "format") {
      header.encoding = encodingOf(words.next(), line);
      has_format = true;
    } else if (word == "element") {
      header.elements.push_back(elementOf(words, bytes.size(), line));
    } else if (word == "property") {
      if (header.elements.empty()) throw PlyProblem{"its PLY header has a bad line: " + oneLine(line)};
      header.elements.back().properties.push_back(propertyOf(words, line));
    }
  }
  if (!has_format) throw PlyProblem{"its PLY header has no format"};
  for (const Element& element : header.elements) {
    if (element.properties.empty() && element.count > 0)
      throw PlyProblem{"its PLY header has no property for element " + oneLine(element.name)};
  }
  return header;
}

// Reads the bodies of all elements.
class Reader {
 public:
  Reader(const Header& header, std::string_view body, Mesh& mesh) : body_(body, header.encoding), mesh_(mesh) {
    for (const Element& element : header.elements) {
      std::vector<NumberType> types;  // of what every row has
      for (const Property& property : element.properties) types.push_back(property.count_type.value_or(property.type));
      body_.expectRows(element.count, types);
      if (element.name == "vertex")
        readVertices(element);
      else if (element.name == "face" || element.name == "tristrips")
        readFaces(element);
      else
        for (std::uint64_t row = 0; row < element.count; ++row) readRow(element, nullptr);
    }
  }

 private:
  // Reads a row. Its scalars go to `scalars_`; the values of the list `list` to `values_`.
  void readRow(const Element& element, const Property* list) {
    scalars_.clear();
    for (const Property& property : element.properties) {
      if (!property.count_type) {
        scalars_.push_back(body_.read(property.type));
        continue;
      }
      const std::uint64_t count = body_.readCount(*property.count_type, property.type);
      if (&property == list) values_.clear();
      for (std::uint64_t i = 0; i < count; ++i) {
        const double value = body_.read(property.type);
        if (&property == list) values_.push_back(value);
      }
    }
  }

  void readVertices(const Element& element) {
    std::array<std::size_t, 3> columns{};
    std::size_t num_found = 0, column = 0;
    for (const Property& property : element.properties) {
      if (property.count_type) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (property.name != std::string(1, static_cast<char>('x' + axis))) continue;
        columns[axis] = column;
        ++num_found;
      }
      ++column;
    }
    if (num_found != 3) throw PlyProblem{"its element vertex has not one x, y and z each"};
    mesh_.vertices.reserve(element.count);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      readRow(element, nullptr);
      mesh_.vertices.push_back(
          {static_cast<float>(scalars_[columns[0]]), static_cast<float>(scalars_[columns[1]]), static_cast<float>(scalars_[columns[2]])});
    }
  }

  void readFaces(const Element& element) {
    const auto list = std::find_if(element.properties.begin(), element.properties.end(), [](const Property& property) {
      return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
    });
    if (list == element.properties.end()) throw PlyProblem{"its element " + element.name + " has no list vertex_indices"};
    mesh_.triangles.reserve(element.count);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      readRow(element, &*list);
      if (element.name == "face")
        addFace(row);
      else
        addStrip();
    }
  }

  std::uint32_t vertexAt(double index) const {
    if (!(index >= 0 && index < static_cast<double>(mesh_.vertices.size())) || index != std::floor(index))
      throw PlyProblem{"a face uses vertex " + numberText(index) + " of " + std::to_string(mesh_.vertices.size())};
    return static_cast<std::uint32_t>(index);
  }

  void addFace(std::uint64_t row) {
    if (values_.empty() || values_.size() > kMaxPolygonCorners)
      throw PlyProblem{"face " + std::to_string(row) + " has " + (values_.empty() ? "no" : std::to_string(values_.size())) +
                       " corners; 1 to " + std::to_string(kMaxPolygonCorners) + " are allowed"};
    corners_.clear();
    for (const double index : values_) corners_.push_back(vertexAt(index));
    if (!triangulate_(mesh_.vertices, corners_, mesh_.triangles)) throw PlyProblem{"its polygons take too long to triangulate"};
  }

  // A strip of triangles with alternating orientation; -1 starts it anew.
  void addStrip() {
    corners_.clear();
    for (const double index : values_) {
      if (index == -1) {
        corners_.clear();
        continue;
      }
      corners_.push_back(vertexAt(index));
      const std::size_t n = corners_.size();
      if (n < 3) continue;
      const bool is_odd = n % 2 == 0;
      mesh_.triangles.push_back({corners_[n - (is_odd ? 2 : 3)], corners_[n - (is_odd ? 3 : 2)], corners_[n - 1]});
    }
  }

  PlyBody body_;
  Mesh& mesh_;
  Triangulator triangulate_;
  std::vector<double> scalars_, values_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

std::string readPly(std::string_view bytes, Mesh& mesh) {
  bytes = withoutByteOrderMark(bytes);
  try {
    const Header header = readHeader(bytes);
    Reader(header, bytes.substr(header.num_bytes), mesh);
  } catch (const PlyProblem& problem) {
    return problem.text;
  }
  return {};
}

}  // namespace taxelsim
