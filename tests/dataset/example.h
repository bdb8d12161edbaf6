// A small data set with synthetic values, and helpers for directories.
#pragma once

#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {

// 11 episodes in shards of 4 (the last has 3), one column of every type at least.
Manifest exampleManifest();

// Element `i` of column `c`, counted over the whole data set. Numbers only.
double exampleNumber(const Column& column, std::size_t c, std::uint64_t i);

// Number of frames of an episode: 1 to 5.
std::uint64_t exampleLength(std::uint64_t episode);

// Values are a function of column and position in the whole data set, so that misplaced rows are detected.
ShardData exampleShard(const Manifest& manifest, std::uint64_t shard);

void writeExample(const std::filesystem::path& directory, const Manifest& manifest);

// Name -> bytes of every file in a directory.
std::map<std::string, std::string> filesIn(const std::filesystem::path& directory);

// Writes the checksum of a file that a test has changed, so that only its content gives the change away.
void renewChecksum(const std::filesystem::path& file);

void overwrite(const std::filesystem::path& file, const std::string& bytes);

// Expects that `function` throws an Error of that kind with a message of one line that contains `part`.
template <typename Function>
void expectError(ErrorKind kind, const std::string& part, Function function) {
  try {
    function();
    ADD_FAILURE() << "no error; expected: " << part;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), kind) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace taxelsim::testing
