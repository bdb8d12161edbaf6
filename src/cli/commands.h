// The subcommands of `taxelsim`, one file each.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>

namespace taxelsim::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitDevice = 1;         // device or file system
inline constexpr int kExitInput = 2;          // bad arguments or files
inline constexpr int kExitInterrupted = 130;  // SIGINT: 128 + 2

// Runs the chosen subcommand after parsing; returns the exit status. May throw Error.
using Action = std::function<int()>;

// Check for unsigned options: CLI11 would let "-1" wrap around.
inline std::string refuseNegative(const std::string& text) {
  return text.starts_with('-') ? text + " is not 0 or more" : "";
}

// Each adds its subcommand to `app`. The chosen subcommand sets `action`, which must outlive parsing.
void addCalibrateReadings(CLI::App& app, Action& action);
void addCharacterize(CLI::App& app, Action& action);
void addCompare(CLI::App& app, Action& action);
void addDevices(CLI::App& app, Action& action);
void addEvaluate(CLI::App& app, Action& action);
void addExperiment(CLI::App& app, Action& action);
void addFrame(CLI::App& app, Action& action);
void addGenerate(CLI::App& app, Action& action);
void addInspect(CLI::App& app, Action& action);
void addRender(CLI::App& app, Action& action);

}  // namespace taxelsim::cli
