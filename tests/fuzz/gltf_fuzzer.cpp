// Changes of inputs of the target gltf, which replace those of libFuzzer.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

#include "fuzz/gltf_mutation.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  std::mt19937 random(seed);
  const std::string changed = taxelsim::fuzz::mutatedGlb({reinterpret_cast<const char*>(data), size}, random);
  if (changed.size() > max_size) return size;
  std::ranges::copy(changed, data);
  return changed.size();
}
