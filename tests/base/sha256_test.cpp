// Known answers from FIPS 180-2, appendix B, and digests of files around the block size of 1 MiB.
#include "base/sha256.h"

#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

std::string digest(std::string_view text) {
  return sha256Hex(std::as_bytes(std::span(text)));
}

TEST(Sha256, MatchesFips180KnownAnswers) {
  EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, DigestOfAFileIsThatOfItsBytes) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "taxelsim_sha256_test.bin";
  for (const std::size_t size : {0u, 1u, 1u << 20, (1u << 20) + 1, 3'000'000u}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 31 + i / 251);
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(sha256File(file), digest(bytes)) << size;
  }
  std::filesystem::remove(file);
  EXPECT_THROW(sha256File(file), Error);
  EXPECT_THROW(sha256File(testing::TempDir()), Error);
}

}  // namespace
}  // namespace taxelsim
