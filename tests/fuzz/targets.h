// Fuzz targets: one per loader of files. Not a test program: corpus_test.cpp runs the targets on stored inputs, libFuzzer on new ones.
//
// A target writes its input to a file of the loader's kind and loads it. The loader either accepts the input or throws an Error(kInput)
// with a message of one line; anything else is a finding: another exception, a crash, a sanitizer's report, a time-out. What is accepted
// must also pass the target's own checks, for example that its text is read back as the same sensor.
#pragma once

#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taxelsim::fuzz {

// Throws std::logic_error, or what the loader must not throw, for a finding.
using Read = void (*)(std::string_view input);
// A random change of an input that keeps its structure.
using Mutate = std::string (*)(std::string_view input, std::mt19937& random);

struct Target {
  std::string_view name;
  Read read;
  Mutate mutate = nullptr;  // none: bytes are changed
};

// The targets by kind of file.
std::span<const Target> textTargets();
std::span<const Target> meshTargets();
std::span<const Target> datasetTargets();

// All of them.
inline std::vector<Target> allTargets() {
  std::vector<Target> all;
  for (const auto targets : {textTargets(), meshTargets(), datasetTargets()}) all.insert(all.end(), targets.begin(), targets.end());
  return all;
}

}  // namespace taxelsim::fuzz
