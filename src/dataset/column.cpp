#include "dataset/column.h"

#include <algorithm>
#include <array>

#include "dataset/manifest_fields.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

struct TypeEntry {
  ScalarType type;
  const char* name;
  std::size_t bytes;  // 0: Column::text_length
};

constexpr std::array kTypes{TypeEntry{ScalarType::kUint8, "uint8", 1},     TypeEntry{ScalarType::kUint16, "uint16", 2},
                            TypeEntry{ScalarType::kInt16, "int16", 2},     TypeEntry{ScalarType::kInt32, "int32", 4},
                            TypeEntry{ScalarType::kUint64, "uint64", 8},   TypeEntry{ScalarType::kFloat32, "float32", 4},
                            TypeEntry{ScalarType::kFloat64, "float64", 8}, TypeEntry{ScalarType::kText, "text", 0}};

const TypeEntry& entryOf(ScalarType type) {
  return *std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeEntry& entry) { return entry.type == type; });
}

}  // namespace

const char* nameOf(ScalarType type) {
  return entryOf(type).name;
}

std::size_t scalarSize(const Column& column) {
  return column.type == ScalarType::kText ? column.text_length : entryOf(column.type).bytes;
}

namespace dataset {
namespace {

constexpr std::size_t kMaxRowBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxDimensions = 8;
constexpr std::size_t kMaxNames = 256;     // of values or bits
constexpr std::size_t kMaxNameBytes = 64;  // kMaxNames of them fit into an attribute

[[noreturn]] void fail(const Column& column, const std::string& problem) {
  throw Error(ErrorKind::kInput, "data set: column \"" + column.name + "\": " + problem);
}

bool isColumnName(const std::string& name) {
  if (name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != std::string::npos) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  });
}

bool isUnsigned(ScalarType type) {
  return type == ScalarType::kUint8 || type == ScalarType::kUint16 || type == ScalarType::kUint64;
}

void checkNames(const Column& column) {
  const auto valid = [](const std::vector<std::string>& names) {
    return names.size() <= kMaxNames && std::all_of(names.begin(), names.end(), [](const std::string& name) {
             return !name.empty() && name.size() <= kMaxNameBytes && name.find('\0') == std::string::npos;
           });
  };
  if (!valid(column.value_names) || !valid(column.bit_names)) fail(column, "at most 256 names of 1 to 64 bytes are allowed");
  if ((!column.value_names.empty() || !column.bit_names.empty()) && !isUnsigned(column.type))
    fail(column, std::string("values and bits have names in columns of unsigned integers only, not ") + nameOf(column.type));
  if (!column.value_names.empty() && !column.bit_names.empty()) fail(column, "has names of values and of bits");
  if (column.bit_names.size() > 8 * scalarSize(column)) fail(column, "has more names than bits");
}

std::string shapeText(const std::vector<std::size_t>& shape) {
  std::string text = "[";
  for (const std::size_t length : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(length);
  return text + "]";
}

}  // namespace

Column episodeEndsColumn() {
  return {.name = kEpisodeEnds,
          .type = ScalarType::kUint64,
          .shape = {},
          .unit = "1",
          .description = "Number of frames up to the end of each episode, counted from the first frame of this file.",
          .per_episode = true};
}

std::size_t rowBytes(const Column& column) {
  std::size_t bytes = scalarSize(column);
  for (const std::size_t length : column.shape) bytes *= length;
  return bytes;
}

void checkColumn(const Column& column) {
  if (!isColumnName(column.name)) fail(column, "a name consists of letters, digits and _, with / between its parts");
  if (!column.name.starts_with(column.per_episode ? "meta/" : "data/"))
    fail(column, "names of columns per frame start with data/, of columns per episode with meta/");
  if (column.name == kEpisodeEnds) fail(column, "is written to every shard and must not be listed");
  if (column.unit.empty() || column.description.empty()) fail(column, "unit (\"1\" for none) or description is missing");
  if (column.unit.size() > kMaxAttributeBytes || column.description.size() > kMaxAttributeBytes)
    fail(column, "unit or description is longer than " + std::to_string(kMaxAttributeBytes) + " bytes");
  const bool is_text = column.type == ScalarType::kText;
  if (is_text ? column.text_length == 0 || column.text_length > kMaxTextLength : column.text_length != 0)
    fail(column, "length is " + std::to_string(column.text_length) + ", not " +
                     (is_text ? "1 to " + std::to_string(kMaxTextLength) + " bytes" : std::string("0 as for all columns without text")));
  checkNames(column);
  if (column.shape.size() > kMaxDimensions) fail(column, "has more than " + std::to_string(kMaxDimensions) + " dimensions");
  std::size_t bytes = scalarSize(column);
  for (const std::size_t length : column.shape) {
    if (length == 0 || length > kMaxRowBytes / bytes) fail(column, "every length of its shape must be 1 or more, a row at most 1 GiB");
    bytes *= length;
  }
}

std::string detailOf(const Column& column) {
  std::string detail = std::string(nameOf(column.type)) + shapeText(column.shape) + " " + column.unit + ", " + column.description;
  if (column.text_length > 0) detail += " length " + std::to_string(column.text_length);
  if (!column.value_names.empty()) detail += " values " + quotedList(column.value_names);
  if (!column.bit_names.empty()) detail += " bits " + quotedList(column.bit_names);
  return detail;
}

std::string writeColumn(const Column& column) {
  std::string text = "  - name: " + column.name + "\n    type: " + nameOf(column.type) + "\n";
  if (column.text_length > 0) text += "    length: " + std::to_string(column.text_length) + "\n";
  text += "    shape: " + shapeText(column.shape) + "\n    unit: " + quoted(column.unit) + "\n    rows: ";
  text += column.per_episode ? "episodes\n" : "frames\n";
  if (!column.value_names.empty()) text += "    values: " + quotedList(column.value_names) + "\n";
  if (!column.bit_names.empty()) text += "    bits: " + quotedList(column.bit_names) + "\n";
  return text + "    description: " + quoted(column.description) + "\n";
}

Column parseColumn(const std::string& file, const YamlTree& node) {
  const Fields fields(file, node);
  Column column;
  column.name = fields.text("name");
  const std::string type_name = fields.text("type");
  const auto type = std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeEntry& entry) { return type_name == entry.name; });
  if (type == kTypes.end()) {
    std::string known;
    for (const TypeEntry& entry : kTypes) known += (known.empty() ? "" : ", ") + std::string(entry.name);
    fields.fail(node, "type \"" + type_name + "\" is not one of " + known);
  }
  column.type = type->type;
  if (fields.find("length") != nullptr) column.text_length = fields.integer("length", kMaxTextLength);
  for (const std::uint64_t length : fields.integers("shape")) column.shape.push_back(length);
  column.unit = fields.text("unit");
  column.description = fields.text("description");
  if (fields.find("values") != nullptr) column.value_names = fields.texts("values");
  if (fields.find("bits") != nullptr) column.bit_names = fields.texts("bits");
  const std::string rows = fields.text("rows");
  if (rows != "frames" && rows != "episodes") fields.fail(node, "rows is \"" + rows + "\", not frames or episodes");
  column.per_episode = rows == "episodes";
  return column;
}

}  // namespace dataset
}  // namespace taxelsim
