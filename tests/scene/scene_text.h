// A small valid scene, and edits of texts.
#pragma once

#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {

inline constexpr std::string_view kScene = R"(format_version: 1
name: small_scene
kind: servo
sensor:
  name: small
  num_rows: 3
  num_cols: 4
  pitch_mm: 3.4
  skin: {thickness_mm: 2, normal_contact_stiffness: 1.73e8}
  psf: {gaussian: {sigma: 0.5, size: 3}}
  readout:
    curve: {counts_per_newton: 2400}
    trigger: 0.02
robot: {free_flying: {}}
objects:
  - sphere: {radius_mm: 5}
    weight: 2
  - cylinder: {radius_mm: 8, length_mm: 40}
    orientation: {rotation: [1, 0, 0, 0]}
episode: {num_steps: 20, simulation_rate: 100, control_rate: 50}
randomization:
  x_mm: [-2, 2]
  yaw_deg: 30
  load: [0.5, 5]
controller:
  tactile_servo: {edge_angle: {kp: 0.78}}
record: [tactile_image, features]
data_set: {episodes: 10, seed: 7}
)";

// Two triangles; the lowest corner is at z = 0.
inline constexpr std::string_view kMeshText = "v 0 0 0\nv 0.01 0 0.001\nv 0 0.01 0.001\nv 0.01 0.01 0\nf 1 2 3\nf 2 4 3\n";

// `text` with its one occurrence of `from` replaced.
inline std::string edited(std::string_view text, std::string_view from, std::string_view to) {
  std::string result(text);
  const std::size_t at = result.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(result.find(from, at + 1), std::string::npos) << from;
  return at == std::string::npos ? result : result.replace(at, from.size(), to);
}

// The message of the error that `load` throws, without the leading name of `file`. Expects one line and kind kInput.
template <typename Function>
std::string refusal(const std::filesystem::path& file, Function&& load) {
  try {
    load();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.starts_with(file.string() + ":") ? message.substr(file.string().size()) : message;
  }
  return "was accepted";
}

}  // namespace taxelsim
