// A copy of a frame's outputs, to compare settings and devices bit by bit.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "taxelsim/simulator.h"

namespace taxelsim::bench {

struct Outputs {
  int num_instances = 0;
  std::vector<std::uint32_t> tactile_image;                        // counts
  std::vector<std::pair<std::string, std::vector<float>>> floats;  // all other outputs, by name
};

Outputs copyOf(const FrameView& frame, int num_instances);

// The first output that differs bitwise, with the instance: "tactile_image of instance 12"; empty: none.
std::string firstDifference(const Outputs& outputs, const FrameView& frame);

// SHA-256 of outputs.
struct OutputHashes {
  std::string inputs;                  // vertices and poses: sine may differ in the last bit between C libraries
  std::string tactile_image;           // integers
  std::string floats;                  // all other outputs, concatenated
  std::vector<std::string> instances;  // (num_instances), of each tactile image, to count those that differ
};

std::string hashOf(std::span<const std::uint32_t> values);
std::vector<std::string> hashesOfImages(const Outputs& outputs);
std::string hashOfFloats(const Outputs& outputs);

}  // namespace taxelsim::bench
