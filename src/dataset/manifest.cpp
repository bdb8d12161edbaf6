#include "dataset/manifest.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>

#include "base/sha256.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {

const char* nameOf(ScalarType type) {
  switch (type) {
    case ScalarType::kUint16:
      return "uint16";
    case ScalarType::kInt32:
      return "int32";
    case ScalarType::kUint64:
      return "uint64";
    case ScalarType::kFloat32:
      return "float32";
    case ScalarType::kFloat64:
      break;
  }
  return "float64";
}

std::size_t scalarSize(ScalarType type) {
  switch (type) {
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kUint64:
    case ScalarType::kFloat64:
      break;
  }
  return 8;
}

namespace dataset {
namespace {

constexpr std::array kTypes{ScalarType::kUint16, ScalarType::kInt32, ScalarType::kUint64, ScalarType::kFloat32, ScalarType::kFloat64};
constexpr std::size_t kMaxRowBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxDimensions = 8;
constexpr std::uint64_t kMaxEpisodes = std::uint64_t{1} << 48;
constexpr int kMaxCompression = 9;

[[noreturn]] void fail(const std::string& message) {
  throw Error(ErrorKind::kInput, "data set: " + message);
}

// A double-quoted YAML scalar.
std::string quoted(const std::string& text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (code < 0x20 || code == 0x7f) {
      result += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
    } else {
      result += c;
    }
  }
  return result + '"';
}

// A literal YAML block if that preserves every byte, since it is readable; a quoted scalar otherwise.
std::string block(const std::string& text) {
  const bool fits_block = text.size() > 1 && text.front() != ' ' && text.front() != '\n' && text.back() == '\n' &&
                          text[text.size() - 2] != '\n' &&
                          std::none_of(text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; });
  if (!fits_block) return quoted(text) + "\n";
  std::string result = "|\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += line.empty() ? "\n" : "  " + line + "\n";
  return result;
}

bool isColumnName(const std::string& name) {
  if (name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != std::string::npos) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/';
  });
}

void checkColumn(const Column& column) {
  const std::string name = "column \"" + column.name + "\"";
  if (!isColumnName(column.name)) fail(name + ": a name consists of letters, digits and _, with / between its parts");
  if (!column.name.starts_with(column.per_episode ? "meta/" : "data/"))
    fail(name + ": names of columns per frame start with data/, of columns per episode with meta/");
  if (column.name == kEpisodeEnds) fail(name + ": is written to every shard and must not be listed");
  if (column.unit.empty() || column.description.empty()) fail(name + ": unit (\"1\" for none) or description is missing");
  if (column.shape.size() > kMaxDimensions) fail(name + ": has more than " + std::to_string(kMaxDimensions) + " dimensions");
  std::size_t bytes = scalarSize(column.type);
  for (const std::size_t length : column.shape) {
    if (length == 0 || length > kMaxRowBytes / bytes) fail(name + ": every length of its shape must be 1 or more, a row at most 1 GiB");
    bytes *= length;
  }
}

// Typed access to the keys of a YAML mapping.
class Fields {
 public:
  Fields(const std::filesystem::path& file, const YAML::Node& node) : file_(file), node_(node) {
    if (!node.IsMap()) fail(node, "is not a mapping");
  }

  template <typename T>
  T get(const char* key) const {
    const YAML::Node value = at(key);
    try {
      return value.as<T>();
    } catch (const YAML::Exception&) {
      fail(value, std::string("key ") + key + " has a value of the wrong type");
    }
  }

  bool has(const char* key) const { return static_cast<bool>(node_[key]); }

  YAML::Node at(const char* key) const {
    const YAML::Node value = node_[key];
    if (!value) fail(node_, std::string("key ") + key + " is missing");
    return value;
  }

  [[noreturn]] void fail(const YAML::Node& where, const std::string& what) const {
    throw Error(ErrorKind::kInput, file_.string() + ":" + std::to_string(where.Mark().line + 1) + ": " + what);
  }

 private:
  const std::filesystem::path& file_;
  YAML::Node node_;
};

Column parseColumn(const std::filesystem::path& file, const YAML::Node& node) {
  const Fields fields(file, node);
  Column column;
  column.name = fields.get<std::string>("name");
  const auto type_name = fields.get<std::string>("type");
  const auto type = std::find_if(kTypes.begin(), kTypes.end(), [&](ScalarType t) { return type_name == nameOf(t); });
  if (type == kTypes.end()) fields.fail(node, "type \"" + type_name + "\" is not one of uint16, int32, uint64, float32, float64");
  column.type = *type;
  column.shape = fields.get<std::vector<std::size_t>>("shape");
  column.unit = fields.get<std::string>("unit");
  column.description = fields.get<std::string>("description");
  const auto rows = fields.get<std::string>("rows");
  if (rows != "frames" && rows != "episodes") fields.fail(node, "rows is \"" + rows + "\", not frames or episodes");
  column.per_episode = rows == "episodes";
  return column;
}

std::string shapeText(const std::vector<std::size_t>& shape) {
  std::string text = "[";
  for (const std::size_t length : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(length);
  return text + "]";
}

}  // namespace

std::string shardName(std::uint64_t shard) {
  const std::string digits = std::to_string(shard);
  return "shard-" + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + ".h5";
}

std::size_t rowBytes(const Column& column) {
  std::size_t bytes = scalarSize(column.type);
  for (const std::size_t length : column.shape) bytes *= length;
  return bytes;
}

std::uint64_t firstEpisode(const Manifest& manifest, std::uint64_t shard) {
  return shard * manifest.episodes_per_shard;
}

std::uint64_t numEpisodes(const Manifest& manifest, std::uint64_t shard) {
  return std::min(manifest.episodes_per_shard, manifest.num_episodes - firstEpisode(manifest, shard));
}

std::string sceneHash(const Manifest& manifest) {
  return sha256Hex(std::as_bytes(std::span(manifest.scene)));
}

void checkManifest(const Manifest& manifest) {
  const auto inRange = [](std::uint64_t value) { return value >= 1 && value <= kMaxEpisodes; };
  if (!inRange(manifest.num_episodes)) fail("num_episodes is " + std::to_string(manifest.num_episodes) + ", not 1 to 2^48");
  if (!inRange(manifest.episodes_per_shard))
    fail("episodes_per_shard is " + std::to_string(manifest.episodes_per_shard) + ", not 1 to 2^48");
  if (manifest.compression < 0 || manifest.compression > kMaxCompression)
    fail("compression is " + std::to_string(manifest.compression) + ", not 0 to 9");
  if (manifest.num_rows < 0 || manifest.num_cols < 0) fail("num_rows and num_cols must not be negative");
  for (const double pitch : manifest.pitch)
    if (!std::isfinite(pitch) || pitch < 0) fail("pitch must be finite and not negative");
  if (manifest.columns.empty()) fail("has no columns");
  std::set<std::string> names{kEpisodeEnds};
  for (const Column& column : manifest.columns) {
    checkColumn(column);
    if (!names.insert(column.name).second) fail("column \"" + column.name + "\" is listed twice");
  }
  for (const std::string& name : names) {
    const auto below = names.lower_bound(name + "/");
    if (below != names.end() && below->starts_with(name + "/"))
      fail("column \"" + name + "\" cannot also be the group of \"" + *below + "\"");
  }
}

std::string writeManifest(const Manifest& manifest) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << "# A taxelsim data set: frames in shard-*.h5, all of them through dataset.h5.\n"
      << "format_version: " << kFormatVersion << "\n"
      << "program_version: " << quoted(manifest.program_version) << "\n"
      << "scene_sha256: " << sceneHash(manifest) << "\n"
      << "seed: " << manifest.seed << "\n"
      << "num_episodes: " << manifest.num_episodes << "\n"
      << "episodes_per_shard: " << manifest.episodes_per_shard << "\n"
      << "compression: " << manifest.compression << "\n"
      << "device: " << quoted(manifest.device) << "\n"
      << (manifest.policy.empty() ? "" : "policy: " + quoted(manifest.policy) + "\n") << "sensor: {name: " << quoted(manifest.sensor_name)
      << ", num_rows: " << manifest.num_rows << ", num_cols: " << manifest.num_cols << ", pitch: [" << numberText(manifest.pitch[0]) << ", "
      << numberText(manifest.pitch[1]) << "]"
      << "}\n"
      << "columns:\n";
  for (const Column& column : manifest.columns) {
    out << "  - name: " << column.name << "\n"
        << "    type: " << nameOf(column.type) << "\n"
        << "    shape: " << shapeText(column.shape) << "\n"
        << "    unit: " << quoted(column.unit) << "\n"
        << "    rows: " << (column.per_episode ? "episodes" : "frames") << "\n"
        << "    description: " << quoted(column.description) << "\n";
  }
  out << "scene: " << block(manifest.scene);
  return std::move(out).str();
}

Manifest parseManifest(const std::filesystem::path& file, const std::string& text) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error(ErrorKind::kInput, file.string() + ":" + std::to_string(error.mark.line + 1) + ": invalid YAML: " + error.msg);
  }
  const Fields fields(file, root);
  const auto version = fields.get<std::uint64_t>("format_version");
  if (version != kFormatVersion)
    fields.fail(fields.at("format_version"), "format_version is " + std::to_string(version) + "; this program reads " +
                                                 std::to_string(kFormatVersion) +
                                                 (version > kFormatVersion ? ": the data set was written by a newer taxelsim" : ""));
  Manifest manifest;
  manifest.program_version = fields.get<std::string>("program_version");
  manifest.seed = fields.get<std::uint64_t>("seed");
  manifest.num_episodes = fields.get<std::uint64_t>("num_episodes");
  manifest.episodes_per_shard = fields.get<std::uint64_t>("episodes_per_shard");
  manifest.compression = fields.get<int>("compression");
  manifest.device = fields.get<std::string>("device");
  if (fields.has("policy")) manifest.policy = fields.get<std::string>("policy");
  const Fields sensor(file, fields.at("sensor"));
  manifest.sensor_name = sensor.get<std::string>("name");
  manifest.num_rows = sensor.get<int>("num_rows");
  manifest.num_cols = sensor.get<int>("num_cols");
  manifest.pitch = sensor.get<std::array<double, 2>>("pitch");
  const YAML::Node columns = fields.at("columns");
  if (!columns.IsSequence()) fields.fail(columns, "columns is not a list");
  for (const YAML::Node& column : columns) manifest.columns.push_back(parseColumn(file, column));
  manifest.scene = fields.get<std::string>("scene");
  if (sceneHash(manifest) != fields.get<std::string>("scene_sha256"))
    fields.fail(fields.at("scene"), "the scene does not match scene_sha256: the file was changed");
  try {
    checkManifest(manifest);
  } catch (const Error& error) {
    throw Error(ErrorKind::kInput, file.string() + ": " + error.what());
  }
  return manifest;
}

void checkSame(const std::filesystem::path& directory, const Manifest& found, const Manifest& requested) {
  const auto compare = [&](const std::string& what, const auto& there, const auto& here) {
    if (there == here) return;
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out << directory.string() << ": holds a data set with another " << what << " (" << there << " there, " << here << " requested)";
    throw Error(ErrorKind::kInput, out.str() + ": choose another directory");
  };
  compare("seed", found.seed, requested.seed);
  compare("program version", found.program_version, requested.program_version);
  compare("device", found.device, requested.device);
  const auto policy = [](const Manifest& manifest) { return manifest.policy.empty() ? std::string("none") : manifest.policy; };
  compare("policy", policy(found), policy(requested));
  compare("number of episodes per shard", found.episodes_per_shard, requested.episodes_per_shard);
  compare("compression", found.compression, requested.compression);
  compare("sensor", found.sensor_name, requested.sensor_name);
  compare("number of rows", found.num_rows, requested.num_rows);
  compare("number of columns", found.num_cols, requested.num_cols);
  compare("pitch", numberText(found.pitch[0]) + " x " + numberText(found.pitch[1]),
          numberText(requested.pitch[0]) + " x " + numberText(requested.pitch[1]));
  compare("scene", sceneHash(found), sceneHash(requested));
  compare("number of recorded columns", found.columns.size(), requested.columns.size());
  for (std::size_t i = 0; i < found.columns.size(); ++i) {
    const Column& a = found.columns[i];
    const Column& b = requested.columns[i];
    compare("column", a.name, b.name);
    const auto detail = [](const Column& c) {
      return std::string(nameOf(c.type)) + shapeText(c.shape) + " " + c.unit + ", " + c.description;
    };
    compare("column " + a.name, detail(a), detail(b));
  }
}

}  // namespace dataset
}  // namespace taxelsim
