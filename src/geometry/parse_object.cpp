#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/log.h"
#include "base/text.h"
#include "geometry/unit_check.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr const char* kAllowed =
    "sphere:R, cylinder:R,L, capsule:R,L, box:X,Y,Z, half_space, cone:R,H, torus:MAJOR,MINOR (metres), or a mesh file (.obj, .stl, .ply, "
    ".glb, .gltf)";

struct ShapeSyntax {
  std::string_view keyword;
  std::size_t num_values;
  Shape (*make)(const std::vector<double>& values);
};

constexpr ShapeSyntax kShapes[] = {
    {"sphere", 1, [](const std::vector<double>& v) -> Shape { return Sphere{v[0]}; }},
    {"cylinder", 2,
     [](const std::vector<double>& v) -> Shape {
       return Cylinder{v[0], v[1]};
     }},
    {"capsule", 2,
     [](const std::vector<double>& v) -> Shape {
       return Capsule{v[0], v[1]};
     }},
    {"box", 3,
     [](const std::vector<double>& v) -> Shape {
       return Box{{v[0], v[1], v[2]}};
     }},
    {"half_space", 0, [](const std::vector<double>&) -> Shape { return HalfSpace{}; }},
    {"cone", 2,
     [](const std::vector<double>& v) -> Shape {
       return Cone{v[0], v[1]};
     }},
    {"torus", 2,
     [](const std::vector<double>& v) -> Shape {
       return Torus{v[0], v[1]};
     }},
};

[[noreturn]] void fail(std::string_view text, const std::string& reason) {
  throw Error(ErrorKind::kInput, "object '" + oneLine(text) + "': " + reason + "; allowed: " + kAllowed);
}

std::vector<double> parseValues(std::string_view text, std::string_view values) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= values.size();) {
    const std::size_t end = std::min(values.find(',', begin), values.size());
    const std::string_view word = values.substr(begin, end - begin);
    double number = 0;
    if (!parseNumber(word, number)) fail(text, std::string("'").append(oneLine(word)).append("' is not a finite number"));
    numbers.push_back(number);
    begin = end + 1;
  }
  return numbers;
}

}  // namespace

Object parseObject(std::string_view text, const MeshOptions& options) {
  const std::size_t colon = text.find(':');
  const std::string_view keyword = text.substr(0, colon);
  for (const ShapeSyntax& syntax : kShapes) {
    if (keyword != syntax.keyword) continue;
    const std::vector<double> values = colon == std::string_view::npos ? std::vector<double>() : parseValues(text, text.substr(colon + 1));
    if (values.size() != syntax.num_values) {
      fail(text, std::string(keyword) + " takes " + std::to_string(syntax.num_values) + " values, not " + std::to_string(values.size()));
    }
    Object object(std::string(text), syntax.make(values));
    checkObject(object);
    const std::string size = implausibleSize(boundsOf(object), "are its sizes in millimetres? They are read as metres: 3 mm are 0.003",
                                             "were its sizes scaled twice? 3 mm are 0.003");
    if (!size.empty()) logWarning("object '" + oneLine(text) + "' " + size);
    return object;
  }

  const std::filesystem::path file(text);
  std::error_code error;
  if (text.empty() || text.find('\0') != std::string_view::npos || !std::filesystem::exists(file, error)) {
    fail(text, "neither a known shape nor a file that exists");
  }
  return Object(file.stem().string(), loadMesh(file, options));
}

}  // namespace taxelsim
