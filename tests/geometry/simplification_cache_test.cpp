#include "geometry/simplification_cache.h"

#include <atomic>

#include "base/sha256.h"
#include "geometry/simplify.h"
#include "support/random_scene.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/simplification_stop.h"

namespace taxelsim {
namespace {

constexpr double kMaxError = 3e-5;  // m
constexpr std::size_t kDigestBytes = 64;

const Mesh& ball() {
  static const Mesh mesh = [] {
    support::Random random(1);
    return support::icosphere(0.02, 5, 0, random);
  }();
  return mesh;
}

// Uses a cache directory of its own.
class SimplificationCache : public ::testing::Test {
 protected:
  SimplificationCache() { setenv("XDG_CACHE_HOME", directory_.path().c_str(), 1); }
  ~SimplificationCache() override {
    if (before_) {
      setenv("XDG_CACHE_HOME", before_->c_str(), 1);
    } else {
      unsetenv("XDG_CACHE_HOME");
    }
  }

  std::vector<std::filesystem::path> stored() const {
    std::vector<std::filesystem::path> files;
    if (!std::filesystem::exists(meshes_)) return files;
    for (const auto& entry : std::filesystem::directory_iterator(meshes_)) files.push_back(entry.path());
    return files;
  }

  // Writes `content` after its digest, as the cache does.
  void store(const std::string& content) const {
    std::ofstream(stored().at(0), std::ios::binary) << sha256Hex(std::as_bytes(std::span(content))) << content;
  }

  const std::optional<std::string> before_ =
      std::getenv("XDG_CACHE_HOME") == nullptr ? std::nullopt : std::optional<std::string>(std::getenv("XDG_CACHE_HOME"));
  const testing::TemporaryDirectory directory_;
  const std::filesystem::path meshes_ = directory_ / "taxelsim" / "meshes";
};

TEST_F(SimplificationCache, ReturnsTheSameMeshAgain) {
  ASSERT_GE(ball().triangles.size(), kMinCachedTriangles);
  const Mesh expected = simplifyMesh(ball(), kMaxError);
  ASSERT_LT(expected.triangles.size(), ball().triangles.size());
  for (const char* call : {"computed", "read"}) {
    const Mesh mesh = simplifyMeshOnce(ball(), kMaxError);
    EXPECT_EQ(mesh.vertices, expected.vertices) << call;
    EXPECT_EQ(mesh.triangles, expected.triangles) << call;
    EXPECT_EQ(stored().size(), 1u) << call;
  }
}

TEST_F(SimplificationCache, ReadsTheFileAndRefusesDamage) {
  const Mesh expected = simplifyMeshOnce(ball(), kMaxError);
  const std::string file = testing::contentOf(stored().at(0));
  std::string content = file.substr(kDigestBytes);

  std::string moved = content;
  moved[16] ^= 1;  // lowest bit of the first coordinate
  store(moved);
  EXPECT_NE(simplifyMeshOnce(ball(), kMaxError).vertices, expected.vertices) << "the file is not read";

  std::string out_of_range = content;
  out_of_range.back() = 127;  // highest byte of the last index
  std::string many = content;
  many[4] = 1;  // 2^32 vertices
  for (const std::string& damaged : {out_of_range, many, content.substr(0, content.size() - 12), std::string(), content + "123456789012"}) {
    store(damaged);
    EXPECT_EQ(simplifyMeshOnce(ball(), kMaxError).vertices, expected.vertices);
    EXPECT_EQ(testing::contentOf(stored().at(0)), file) << "the damaged file is not replaced";
  }
  std::string flipped = file;
  flipped[kDigestBytes + 16] ^= 1;
  std::ofstream(stored().at(0), std::ios::binary) << flipped;
  EXPECT_EQ(simplifyMeshOnce(ball(), kMaxError).vertices, expected.vertices);
}

TEST_F(SimplificationCache, KeepsMeshesAndErrorsApart) {
  const Mesh fine = simplifyMeshOnce(ball(), kMaxError);
  const Mesh coarse = simplifyMeshOnce(ball(), 4 * kMaxError);
  EXPECT_LT(coarse.triangles.size(), fine.triangles.size());
  Mesh other = ball();
  for (float& value : other.vertices[0]) value *= 1.001f;
  simplifyMeshOnce(other, kMaxError);
  EXPECT_EQ(stored().size(), 3u);

  const auto simplify = [](const Mesh& mesh, double max_error) { return simplifyMeshOnce(mesh, max_error).triangles.size(); };
  EXPECT_EQ(simplify(ball(), 0), ball().triangles.size());
  support::Random random(1);
  simplify(support::icosphere(0.02, 4, 0, random), kMaxError);
  EXPECT_EQ(stored().size(), 3u) << "small meshes, and those that keep every triangle, are not stored";
}

TEST_F(SimplificationCache, RemembersMeshesThatCannotBeSimplified) {
  constexpr double kTooSmall = 1e-7;  // m, below the sagitta of every triangle
  for (int n = 0; n < 2; ++n) {
    EXPECT_EQ(simplifyMeshOnce(ball(), kTooSmall).triangles, ball().triangles);
    EXPECT_LT(testing::contentOf(stored().at(0)).size(), 100u);
  }
}

TEST_F(SimplificationCache, AStoppedSimplificationIsNotStored) {
  std::atomic<bool> stop = true;
  {
    const SimplificationStop scope(stop);
    EXPECT_EQ(simplifyMeshOnce(ball(), kMaxError).triangles.size(), ball().triangles.size());
    EXPECT_TRUE(stored().empty());
    stop = false;
    EXPECT_LT(simplifyMeshOnce(ball(), kMaxError).triangles.size(), ball().triangles.size());
  }
  stop = true;
  EXPECT_LT(simplifyMesh(ball(), kMaxError).triangles.size(), ball().triangles.size()) << "after the scope";
}

TEST_F(SimplificationCache, WorksWithoutADirectory) {
  std::ofstream(directory_ / "taxelsim") << "a file where the directory should be";
  EXPECT_LT(simplifyMeshOnce(ball(), kMaxError).triangles.size(), ball().triangles.size());
}

}  // namespace
}  // namespace taxelsim
