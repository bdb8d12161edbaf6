// Options of all commands that simulate the episodes of a scene.
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "taxelsim/device.h"
#include "taxelsim/scene.h"

namespace taxelsim::cli {

struct SceneOptions {
  std::string scene, device;
  SceneOverrides overrides{};
  int batch_size = 0;
  bool validation = false;
};

// Adds SCENE, --episodes, --seed, --condition, --batch-size, --device and --validation. `options` must outlive the parsing.
void addSceneOptions(CLI::App& command, SceneOptions& options, int default_batch_size);

// Adds --condition; `overrides` must outlive the parsing.
CLI::Option* addConditionOption(CLI::App& command, SceneOverrides& overrides);

// Adds --device and --validation; the references must outlive the parsing.
void addDeviceOptions(CLI::App& command, std::string& device, bool& validation);

// Loads the scene. Shows the time that it takes if that is long.
Scene loadSceneOf(const SceneOptions& options);

Device openDevice(const SceneOptions& options);

// Name of the scene, with its condition in brackets if it is not nominal.
std::string sceneTitle(const Scene& scene);

}  // namespace taxelsim::cli
