// What a frame gives, kept so that the frames of two settings, or of two devices, can be held against each other.
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
  std::vector<std::pair<std::string, std::vector<float>>> floats;  // every other output that the frame has, by name
};

Outputs copyOf(const FrameView& frame, int num_instances);

// The first output of the frame whose bits differ, with the instance: "tactile_image of instance 12"; empty: none does.
std::string firstDifference(const Outputs& outputs, const FrameView& frame);

// SHA-256 of bits.
struct OutputHashes {
  std::string inputs;                  // vertices and poses: a C library's sine may differ from another's in the last bit
  std::string tactile_image;           // integers
  std::string floats;                  // all other outputs, one after another
  std::vector<std::string> instances;  // (num_instances): of each tactile image, so that it can be told how many differ
};

std::string hashOf(std::span<const std::uint32_t> values);
std::vector<std::string> hashesOfImages(const Outputs& outputs);
std::string hashOfFloats(const Outputs& outputs);

}  // namespace taxelsim::bench
