#include "base/files.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace {

// In the order of fsync().
std::vector<ino_t> flushed;  // inodes
std::vector<std::filesystem::path> flushed_names;

}  // namespace

// Replaces that of the C library.
extern "C" int fsync(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) == 0) flushed.push_back(status.st_ino);
  flushed_names.push_back(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor)));
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

namespace taxelsim::testing {
namespace {

ino_t inodeOf(const std::filesystem::path& file) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

void write(const std::filesystem::path& file, const std::string& text) {
  writeFileAtomically(file, std::as_bytes(std::span(text)));
}

constexpr std::uintmax_t kMaxBytes = 100;

std::string read(const std::filesystem::path& file) {
  return readTextFile(file, kMaxBytes);
}

std::size_t numFilesIn(const TemporaryDirectory& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory.path()), {}));
}

TEST(Files, WritesAndReplacesAFile) {
  const TemporaryDirectory directory;
  write(directory / "a.txt", "long first text");
  EXPECT_EQ(read(directory / "a.txt"), "long first text");
  write(directory / "a.txt", "second");
  EXPECT_EQ(read(directory / "a.txt"), "second");
  EXPECT_EQ(numFilesIn(directory), 1u) << "no temporary file is left";
}

TEST(Files, WritesPiecesWithZerosBetweenThem) {
  const TemporaryDirectory directory;
  const std::string a = "ab", b = "c";
  writeFileAtomically(directory / "a.bin", FileContent{.size = 6,
                                                       .pieces = {{.offset = 1, .bytes = std::as_bytes(std::span(a))},
                                                                  {.offset = 4, .bytes = std::as_bytes(std::span(b))}},
                                                       .buffer = {}});
  EXPECT_EQ(read(directory / "a.bin"), std::string("\0ab\0c\0", 6));
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
  EXPECT_THROW(read(directory / "no_such.txt"), Error);
}

TEST(Files, ReadsOnlyRegularFilesOfLimitedSize) {
  const TemporaryDirectory directory;
  write(directory / "full.txt", std::string(kMaxBytes, 'a'));
  EXPECT_EQ(read(directory / "full.txt").size(), kMaxBytes);
  write(directory / "long.txt", std::string(kMaxBytes + 1, 'a'));
  EXPECT_EQ(inputFileProblem(directory / "long.txt", kMaxBytes), "101 bytes are too many: at most 100");
  ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(inputFileProblem(directory / "fifo", kMaxBytes), "not a regular file");
  EXPECT_EQ(inputFileProblem("/dev/zero", kMaxBytes), "not a regular file");
  EXPECT_EQ(inputFileProblem(directory.path(), kMaxBytes), "a directory, not a file");
  EXPECT_EQ(inputFileProblem(directory / "no_such.txt", kMaxBytes), "no such file");
  EXPECT_THROW(read(directory / "fifo"), Error);
}

// Writers on several machines can have equal process numbers, and another user must not be able to place a link under the name.
TEST(Files, NoTwoTemporaryNamesAreEqual) {
  const TemporaryDirectory directory;
  flushed_names.clear();
  for (int i = 0; i < 2; ++i) write(directory / "a.txt", "text");
  ASSERT_EQ(flushed_names.size(), 4u) << "the file and its directory, twice";
  EXPECT_NE(flushed_names[0], flushed_names[2]);
  for (const int file : {0, 2}) EXPECT_TRUE(isTemporaryName(flushed_names[file].filename())) << flushed_names[file];
}

TEST(Files, FlushesTheParentsOfNewDirectories) {
  const TemporaryDirectory directory;
  flushed.clear();
  createDirectories(directory / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(directory / "a/b/c"));
  EXPECT_EQ(flushed, (std::vector<ino_t>{inodeOf(directory.path()), inodeOf(directory / "a"), inodeOf(directory / "a/b")}));
  flushed.clear();
  createDirectories(directory / "a/b/");
  EXPECT_TRUE(flushed.empty()) << "nothing is new";
  write(directory / "file", "");
  EXPECT_THROW(createDirectories(directory / "file/a"), Error);
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
