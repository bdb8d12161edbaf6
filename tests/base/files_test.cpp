#include "base/files.h"

#include <gtest/gtest.h>

#include "support/temporary_directory.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

void write(const std::filesystem::path& file, const std::string& text) {
  writeFileAtomically(file, std::as_bytes(std::span(text)));
}

std::size_t numFilesIn(const TemporaryDirectory& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory.path()), {}));
}

TEST(Files, WritesAndReplacesAFile) {
  const TemporaryDirectory directory;
  write(directory / "a.txt", "long first text");
  EXPECT_EQ(readTextFile(directory / "a.txt"), "long first text");
  write(directory / "a.txt", "second");
  EXPECT_EQ(readTextFile(directory / "a.txt"), "second");
  EXPECT_EQ(numFilesIn(directory), 1u) << "no temporary file is left";
}

TEST(Files, WritesPiecesWithZerosBetweenThem) {
  const TemporaryDirectory directory;
  const std::string a = "ab", b = "c";
  writeFileAtomically(directory / "a.bin", FileContent{.size = 6,
                                                       .pieces = {{.offset = 1, .bytes = std::as_bytes(std::span(a))},
                                                                  {.offset = 4, .bytes = std::as_bytes(std::span(b))}},
                                                       .buffer = {}});
  EXPECT_EQ(readTextFile(directory / "a.bin"), std::string("\0ab\0c\0", 6));
}

TEST(Files, KeepsTheTargetAndLeavesNoTemporaryFileIfWritingFails) {
  const TemporaryDirectory directory;
  std::filesystem::create_directories(directory / "taken/inside");
  try {
    write(directory / "taken", "text");
    ADD_FAILURE() << "a directory was replaced";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_NE(std::string(error.what()).find("taken"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(std::filesystem::is_directory(directory / "taken/inside"));
  EXPECT_EQ(numFilesIn(directory), 1u);
  EXPECT_THROW(write(directory / "no_such/a.txt", "text"), Error);
  EXPECT_THROW(readTextFile(directory / "no_such.txt"), Error);
}

TEST(Files, RecognizesNamesOfTemporaryFiles) {
  EXPECT_TRUE(isTemporaryName(".shard-000002.h5.tmp-77"));
  EXPECT_FALSE(isTemporaryName("shard-000002.h5"));
  EXPECT_FALSE(isTemporaryName(".lock"));
}

TEST(Files, RemovesAFileThatMayBeMissing) {
  const TemporaryDirectory directory;
  write(directory / "a.txt", "text");
  removeFile(directory / "a.txt");
  EXPECT_EQ(numFilesIn(directory), 0u);
  EXPECT_NO_THROW(removeFile(directory / "a.txt"));
}

}  // namespace
}  // namespace taxelsim::testing
