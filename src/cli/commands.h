// The subcommands of `taxelsim`, one file each. Not a library: nothing here is for other programs.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>

namespace taxelsim::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitDevice = 1;         // device or file system
inline constexpr int kExitInput = 2;          // bad arguments or files
inline constexpr int kExitInterrupted = 130;  // Ctrl-C, as shells count it

// What the chosen subcommand does once all arguments are parsed; gives the exit status. May throw Error.
using Action = std::function<int()>;

// A check for options that hold an unsigned number: CLI11 lets "-1" wrap around.
inline std::string refuseNegative(const std::string& text) {
  return text.starts_with('-') ? text + " is not 0 or more" : "";
}

// Each adds its subcommand to `app`; choosing it sets `action`, which outlives the call.
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
