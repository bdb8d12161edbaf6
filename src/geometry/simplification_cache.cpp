#include "geometry/simplification_cache.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/files.h"
#include "base/log.h"
#include "base/sha256.h"
#include "geometry/simplify.h"
#include "geometry/triangle_tree.h"
#include "taxelsim/version.h"

namespace taxelsim {
namespace {

constexpr std::size_t kDigestBytes = 64;

template <typename Values>
std::span<const std::byte> bytesOf(const Values& values) {
  return std::as_bytes(std::span(values));
}

// Empty if the user has no cache directory.
std::filesystem::path cacheFile(const Mesh& mesh, double max_error) {
  const std::filesystem::path directory = userCacheDirectory();
  if (directory.empty()) return {};
  Sha256 digest;
  const std::array<std::uint64_t, 2> counts{mesh.vertices.size(), mesh.triangles.size()};
  digest.add(std::as_bytes(std::span(kVersion, std::strlen(kVersion))));
  digest.add(std::as_bytes(std::span(&kSimplificationVersion, 1)));
  digest.add(std::as_bytes(std::span(&max_error, 1)));
  digest.add(bytesOf(counts));
  digest.add(bytesOf(mesh.vertices));
  digest.add(bytesOf(mesh.triangles));
  return directory / "meshes" / digest.finish();
}

// Copies the next values of `bytes`, and removes them from it.
template <typename Values>
void take(std::span<const std::byte>& bytes, Values& values) {
  const std::size_t size = bytesOf(values).size();
  std::memcpy(values.data(), bytes.data(), size);
  bytes = bytes.subspan(size);
}

// Nothing if the file is missing or damaged, or if the mesh has more vertices or triangles than `original`.
std::optional<Mesh> readSimplified(const std::filesystem::path& file, const Mesh& original) {
  std::array<std::uint64_t, 2> counts{};
  const auto sizeOf = [](std::uint64_t num_vertices, std::uint64_t num_triangles) {
    return kDigestBytes + sizeof(counts) + num_vertices * sizeof(original.vertices[0]) + num_triangles * sizeof(original.triangles[0]);
  };
  if (!inputFileProblem(file, sizeOf(original.vertices.size(), original.triangles.size())).empty()) return {};
  const std::string content = readTextFile(file, kMaxSimplificationCacheBytes);
  if (content.size() < sizeOf(0, 0)) return {};
  std::span<const std::byte> bytes = std::as_bytes(std::span(content)).subspan(kDigestBytes);
  if (sha256Hex(bytes) != content.substr(0, kDigestBytes)) return {};
  take(bytes, counts);
  if (counts[0] > original.vertices.size() || counts[1] > original.triangles.size()) return {};
  if (content.size() != sizeOf(counts[0], counts[1])) return {};
  if (counts[1] == 0) return original;
  Mesh mesh;
  mesh.vertices.resize(counts[0]);
  mesh.triangles.resize(counts[1]);
  take(bytes, mesh.vertices);
  take(bytes, mesh.triangles);
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    if (*std::ranges::max_element(triangle) >= counts[0]) return {};
  }
  return mesh;
}

void writeSimplified(const std::filesystem::path& file, const Mesh& mesh) {
  const std::array<std::uint64_t, 2> counts{mesh.vertices.size(), mesh.triangles.size()};
  std::vector<std::byte> content(kDigestBytes);
  for (const std::span<const std::byte> part : {bytesOf(counts), bytesOf(mesh.vertices), bytesOf(mesh.triangles)}) {
    content.insert(content.end(), part.begin(), part.end());
  }
  const std::string digest = sha256Hex(std::span(content).subspan(kDigestBytes));
  std::memcpy(content.data(), digest.data(), kDigestBytes);
  createDirectories(file.parent_path());
  writeFileAtomically(file, content);
}

// Removes the files that were written first, until the rest is within the limit. Other programs may remove files at the same time.
void removeOldest(const std::filesystem::path& directory) {
  struct Entry {
    std::filesystem::file_time_type time;
    std::uintmax_t size;
    std::filesystem::path file;
  };
  std::vector<Entry> entries;
  std::uintmax_t total = 0;
  for (const std::filesystem::directory_entry& file : std::filesystem::directory_iterator(directory)) {
    std::error_code error;
    const Entry entry{file.last_write_time(error), file.file_size(error), file.path()};
    if (error) continue;
    total += entry.size;
    entries.push_back(entry);
  }
  std::ranges::sort(entries, {}, &Entry::time);
  for (const Entry& entry : entries) {
    if (total <= kMaxSimplificationCacheBytes) return;
    removeFile(entry.file);
    total -= entry.size;
  }
}

}  // namespace

Mesh simplifyMeshOnce(const Mesh& mesh, double max_error) {
  if (!(max_error > 0) || mesh.triangles.size() < kMinCachedTriangles) return simplifyMesh(mesh, max_error);
  const std::filesystem::path file = cacheFile(mesh, max_error);
  if (file.empty()) return simplifyMesh(mesh, max_error);
  try {
    if (std::optional<Mesh> stored = readSimplified(file, mesh)) return *std::move(stored);
  } catch (const std::exception& error) {
    logDebug(std::string("simplified mesh not read: ") + error.what());
  }
  Mesh simplified = simplifyMesh(mesh, max_error);
  if (const std::atomic<bool>* const stop = stopOfThisThread(); stop != nullptr && *stop) return simplified;
  try {
    writeSimplified(file, simplified.triangles.size() < mesh.triangles.size() ? simplified : Mesh{});
    removeOldest(file.parent_path());
  } catch (const std::exception& error) {
    logDebug(std::string("simplified mesh not saved: ") + error.what());
  }
  return simplified;
}

}  // namespace taxelsim
