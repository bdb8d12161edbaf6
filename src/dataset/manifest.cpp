#include "dataset/manifest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <locale>
#include <set>
#include <sstream>

#include "base/sha256.h"
#include "base/text.h"
#include "base/yaml_parse.h"
#include "dataset/checksum.h"
#include "dataset/column.h"
#include "dataset/manifest_fields.h"
#include "dataset/scene_difference.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim::dataset {
namespace {

constexpr std::uint64_t kMaxEpisodes = std::uint64_t{1} << 48;
constexpr std::size_t kMaxManifestValues = 3'000'000;  // of its YAML: kMaxListedEpisodes, and kMaxColumns with all their names
constexpr int kMaxCompression = 9;

[[noreturn]] void fail(const std::string& message) {
  throw Error(ErrorKind::kInput, "data set: " + message);
}

// Data sets of earlier versions have no such key.
std::string probeLine(const Manifest& manifest) {
  return manifest.probe_sha256.empty() ? "" : "probe_sha256: " + manifest.probe_sha256 + "\n";
}

// Data sets of all episodes have no such key.
std::string episodesLine(const Manifest& manifest) {
  if (manifest.episodes.empty()) return "";
  std::string line = "episodes: [";
  for (std::size_t i = 0; i < manifest.episodes.size(); ++i) line += (i > 0 ? ", " : "") + std::to_string(manifest.episodes[i]);
  return line + "]\n";
}

}  // namespace

std::string shardName(std::uint64_t shard) {
  const std::string digits = std::to_string(shard);
  return "shard-" + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + ".h5";
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
  if (manifest.episodes_per_shard < 1 || manifest.episodes_per_shard > kMaxEpisodesPerShard)
    fail("episodes_per_shard is " + std::to_string(manifest.episodes_per_shard) + ", not 1 to " + std::to_string(kMaxEpisodesPerShard));
  if (manifest.numShards() > kMaxShards)
    fail("episodes_per_shard is " + std::to_string(manifest.episodes_per_shard) + ": " + std::to_string(manifest.numShards()) +
         " shards are not allowed: at most " + std::to_string(kMaxShards));
  if (manifest.episodes.size() > kMaxListedEpisodes)
    fail("episodes has " + std::to_string(manifest.episodes.size()) + " numbers, which is not allowed: at most " +
         std::to_string(kMaxListedEpisodes));
  if (!manifest.episodes.empty() && manifest.episodes.size() != manifest.num_episodes)
    fail("episodes has " + std::to_string(manifest.episodes.size()) + " numbers, num_episodes is " + std::to_string(manifest.num_episodes));
  if (manifest.compression < 0 || manifest.compression > kMaxCompression)
    fail("compression is " + std::to_string(manifest.compression) + ", not 0 to 9");
  if (manifest.chunk_bytes < kMinChunkBytes || manifest.chunk_bytes > kMaxChunkBytes)
    fail("chunk_bytes is " + std::to_string(manifest.chunk_bytes) + ", not " + std::to_string(kMinChunkBytes) + " to " +
         std::to_string(kMaxChunkBytes));
  for (const std::string* text : {&manifest.program_version, &manifest.device, &manifest.policy})
    if (text->size() > kMaxAttributeBytes)
      fail("program_version, device or policy is longer than " + std::to_string(kMaxAttributeBytes) + " bytes");
  if (!manifest.probe_sha256.empty() && !isDigest(manifest.probe_sha256))
    fail("probe_sha256 is not a SHA-256 of " + std::to_string(kDigestDigits) + " hexadecimal digits");
  for (const int side : {manifest.num_rows, manifest.num_cols})
    if (side < 0 || side > kMaxTaxelsPerSide)
      fail("num_rows or num_cols is " + std::to_string(side) + ", not 0 to " + std::to_string(kMaxTaxelsPerSide));
  for (const double pitch : manifest.pitch)
    if (!std::isfinite(pitch) || pitch < 0) fail("pitch must be finite and not negative");
  if (manifest.columns.empty() || manifest.columns.size() > kMaxColumns)
    fail("has " + std::to_string(manifest.columns.size()) + " columns, not 1 to " + std::to_string(kMaxColumns));
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
      << "format_version: " << manifest.format_version << "\n"
      << "program_version: " << quoted(manifest.program_version) << "\n"
      << "scene_sha256: " << sceneHash(manifest) << "\n"
      << "seed: " << manifest.seed << "\n"
      << "num_episodes: " << manifest.num_episodes << "\n"
      << episodesLine(manifest) << "episodes_per_shard: " << manifest.episodes_per_shard << "\n"
      << "compression: " << manifest.compression << "\n"
      << "chunk_bytes: " << manifest.chunk_bytes << "\n"
      << "device: " << quoted(manifest.device) << "\n"
      << "policy: " << quoted(manifest.policy) << "\n"
      << probeLine(manifest) << "sensor: {name: " << quoted(manifest.sensor_name) << ", num_rows: " << manifest.num_rows
      << ", num_cols: " << manifest.num_cols << ", pitch: [" << numberText(manifest.pitch[0]) << ", " << numberText(manifest.pitch[1])
      << "]"
      << "}\n"
      << "columns:\n";
  for (const Column& column : manifest.columns) out << writeColumn(column);
  out << "scene: " << block(manifest.scene);
  return std::move(out).str();
}

Manifest parseManifest(const std::filesystem::path& file, const std::string& text) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  const std::string name = file.string();
  const YamlTree root = parseYaml(text, name, kMaxManifestValues);
  const Fields fields(name, root);
  Manifest manifest;
  manifest.format_version = fields.integer("format_version", kAny);
  if (manifest.format_version < 1 || manifest.format_version > kDatasetFormat)
    fields.fail(fields.at("format_version"),
                "format_version is " + std::to_string(manifest.format_version) + "; this program reads 1 to " +
                    std::to_string(kDatasetFormat) +
                    (manifest.format_version > kDatasetFormat ? ": the data set was written by a newer taxelsim" : ""));
  manifest.program_version = fields.text("program_version");
  manifest.seed = fields.integer("seed", kAny);
  manifest.num_episodes = fields.integer("num_episodes", kMaxEpisodes);
  manifest.episodes_per_shard = fields.integer("episodes_per_shard", kMaxEpisodes);
  manifest.compression = static_cast<int>(fields.integer("compression", kMaxCompression));
  manifest.device = fields.text("device");
  if (manifest.format_version > 1) {
    manifest.chunk_bytes = fields.integer("chunk_bytes", kMaxChunkBytes);
    manifest.policy = fields.text("policy");
    if (fields.find("probe_sha256") != nullptr) manifest.probe_sha256 = fields.text("probe_sha256");
    if (fields.find("episodes") != nullptr) manifest.episodes = fields.integers("episodes");
  }
  const Fields sensor(name, fields.at("sensor"));
  manifest.sensor_name = sensor.text("name");
  manifest.num_rows = static_cast<int>(sensor.integer("num_rows", kMaxTaxelsPerSide));
  manifest.num_cols = static_cast<int>(sensor.integer("num_cols", kMaxTaxelsPerSide));
  const std::vector<double> pitch = sensor.numbers("pitch", manifest.pitch.size());
  std::copy(pitch.begin(), pitch.end(), manifest.pitch.begin());
  for (const YamlTree& column : fields.list("columns")) manifest.columns.push_back(parseColumn(name, column));
  manifest.scene = fields.text("scene");
  if (sceneHash(manifest) != fields.text("scene_sha256"))
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
  compare("format", found.format_version, requested.format_version);
  compare("seed", found.seed, requested.seed);
  if (found.episodes != requested.episodes)
    throw Error(ErrorKind::kInput, directory.string() + ": holds a data set of other episodes: choose another directory");
  compare("program version", found.program_version, requested.program_version);
  compare("device", found.device, requested.device);
  const auto policy = [](const Manifest& manifest) { return manifest.policy.empty() ? std::string("none") : manifest.policy; };
  compare("policy", policy(found), policy(requested));
  compare("number of episodes per shard", found.episodes_per_shard, requested.episodes_per_shard);
  compare("compression", found.compression, requested.compression);
  compare("chunk size", found.chunk_bytes, requested.chunk_bytes);
  compare("sensor", found.sensor_name, requested.sensor_name);
  compare("number of rows", found.num_rows, requested.num_rows);
  compare("number of columns", found.num_cols, requested.num_cols);
  compare("pitch", numberText(found.pitch[0]) + " x " + numberText(found.pitch[1]),
          numberText(requested.pitch[0]) + " x " + numberText(requested.pitch[1]));
  if (found.scene != requested.scene)
    throw Error(ErrorKind::kInput, directory.string() + ": holds a data set of another scene: " +
                                       describeSceneDifference(found.scene, requested.scene) + ": choose another directory");
  if (!found.probe_sha256.empty() && !requested.probe_sha256.empty() && found.probe_sha256 != requested.probe_sha256)
    throw Error(ErrorKind::kInput, directory.string() +
                                       ": holds a data set of a machine that computes other values than this one, although " +
                                       "both have the device " + found.device + " (probe_sha256: " + found.probe_sha256 + " there, " +
                                       requested.probe_sha256 + " here): use machines with equal processors, or another directory");
  compare("number of recorded columns", found.columns.size(), requested.columns.size());
  for (std::size_t i = 0; i < found.columns.size(); ++i) {
    const Column& a = found.columns[i];
    const Column& b = requested.columns[i];
    compare("column", a.name, b.name);
    compare("column " + a.name, detailOf(a), detailOf(b));
  }
}

}  // namespace taxelsim::dataset
