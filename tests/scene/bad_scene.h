// Scenes with one error each, and the message that loadScene() gives.
#pragma once

#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// kScene with `from` replaced by `to`.
struct BadScene {
  std::string_view from;
  std::string_view to;
  std::string_view message;  // the start of the message, after the name of the scene file
};

// The message for a scene file with this text, without the paths of files; "was accepted" if there is none.
inline std::string refusalOf(std::string_view text) {
  const testing::TemporaryDirectory directory;
  directory.write("mesh.obj", kMeshText);
  directory.write("not_a_mesh.obj", "nothing here\n");
  directory.write("sensor.yaml", "format_version: 1\nname: x\nnum_rows: 0\n");
  directory.write("other.gltf", "{}");
  directory.write("OTHER.GLTF", "{}");
  const std::filesystem::path file = directory.write("scene.yaml", text);
  std::string message = refusal(file, [&] { loadScene(file); });
  const std::string prefix = directory.path().string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) message.erase(at, prefix.size());
  return message;
}

inline void expectRefusals(std::initializer_list<BadScene> table) {
  for (const BadScene& bad : table) {
    SCOPED_TRACE(bad.to);
    EXPECT_THAT(refusalOf(edited(kScene, bad.from, bad.to)), ::testing::StartsWith(std::string(bad.message)));
  }
}

inline constexpr std::string_view kSkin = "{thickness_mm: 2, normal_contact_stiffness: 1.73e8}";
inline constexpr std::string_view kPsf = "{gaussian: {sigma: 0.5, size: 3}}";
inline constexpr std::string_view kCurve = "{counts_per_newton: 2400}";
inline constexpr std::string_view kEpisode = "{num_steps: 20, simulation_rate: 100, control_rate: 50}";
inline constexpr std::string_view kRotation = "{rotation: [1, 0, 0, 0]}";
inline constexpr std::string_view kSphere = "sphere: {radius_mm: 5}";

}  // namespace taxelsim
