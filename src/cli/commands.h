// The subcommands of `taxelsim`, one file each.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <functional>
#include <string>

namespace taxelsim::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitDevice = 1;         // device or file system
inline constexpr int kExitInput = 2;          // bad arguments or files
inline constexpr int kExitInterrupted = 130;  // SIGINT: 128 + 2

// Status and line for an exception that ends the program.
struct Failure {
  int status;
  std::string message;
};

// Of the std::exception that is being handled.
Failure currentFailure();

// Runs the chosen subcommand after parsing; returns the exit status. May throw Error.
using Action = std::function<int()>;

// Checks of options: the message, or nothing if the text is allowed.
//
// For unsigned options: CLI11 would let "-1" wrap around.
std::string refuseNegative(const std::string& text);

// For options that name a picture to write.
std::string requirePngName(const std::string& file);

// The check without its list of allowed values in --help, where CLI11 would append it to the option's type.
CLI::Validator silent(CLI::Validator check);

// Each adds its subcommand to `app`. The chosen subcommand sets `action`, which must outlive parsing.
void addCalibrateReadings(CLI::App& app, Action& action);
void addCharacterize(CLI::App& app, Action& action);
void addCompare(CLI::App& app, Action& action);
void addDevices(CLI::App& app, Action& action);
void addEvaluate(CLI::App& app, Action& action);
void addExperiment(CLI::App& app, Action& action);
void addFinish(CLI::App& app, Action& action);
void addFrame(CLI::App& app, Action& action);
void addGenerate(CLI::App& app, Action& action);
void addInspect(CLI::App& app, Action& action);
void addRender(CLI::App& app, Action& action);
void addRobot(CLI::App& app, Action& action);
void addSchema(CLI::App& app, Action& action);
void addStiffness(CLI::App& app, Action& action);

}  // namespace taxelsim::cli
