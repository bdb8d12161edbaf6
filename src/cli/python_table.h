// Subcommands that are written in Python: the program starts python3 for them, and the package runs them.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>

namespace taxelsim::cli {

// `main(arguments) -> int` of the module taxelsim.commands.<name> runs one.
struct PythonSubcommand {
  const char* name;
  // An argument must be one of these options, or end like one of these file names; without words Python always runs it.
  std::array<std::string_view, 2> words;
  const char* description;  // empty if the subcommand exists in C++ as well
};

inline constexpr std::array kPythonSubcommands{
    PythonSubcommand{.name = "evaluate", .words = {"--policy"}, .description = ""},
    PythonSubcommand{.name = "finish", .words = {"--card"}, .description = ""},
    PythonSubcommand{.name = "inspect", .words = {"--format"}, .description = ""},
    PythonSubcommand{.name = "render", .words = {".mp4", ".gif"}, .description = ""},
    PythonSubcommand{.name = "robot", .words = {"--view"}, .description = ""},
    PythonSubcommand{.name = "report", .words = {}, .description = "Write a data set as a page of HTML, or its card"},
    PythonSubcommand{.name = "view", .words = {}, .description = "Show episodes of a data set or a scene in the viewer Rerun"},
    PythonSubcommand{.name = "play", .words = {}, .description = "Press an object into a sensor in the browser"},
    PythonSubcommand{.name = "ros2", .words = {}, .description = "Publish the touch of a scene to ROS 2, without an installation of ROS"},
    PythonSubcommand{
        .name = "sensor", .words = {}, .description = "Make a sensor file from places of taxels, or from the surface of a mesh"},
    PythonSubcommand{
        .name = "export", .words = {}, .description = "Write a data set for LeRobot, Open-X-Tactile, Zarr, robomimic or ROS 2"},
    PythonSubcommand{
        .name = "import", .words = {}, .description = "Make a measurement from a recording: CSV, LeRobot, Open-X-Tactile, robomimic, ROS"},
};

inline bool isMatch(std::string_view argument, std::string_view word) {
  return !word.empty() && (word.starts_with('.') ? argument.ends_with(word) : argument.substr(0, argument.find('=')) == word);
}

// Gives the words that select Python among the arguments after the program's name: "view", "render a.mp4"; "" for a subcommand in C++.
inline std::string pythonCommand(std::span<const std::string> arguments) {
  for (const PythonSubcommand& subcommand : kPythonSubcommands) {
    if (arguments.empty() || arguments[0] != subcommand.name) continue;
    if (subcommand.words[0].empty()) return arguments[0];
    for (const std::string& argument : arguments.subspan(1))
      for (const std::string_view word : subcommand.words)
        if (isMatch(argument, word)) return arguments[0] + " " + argument;
  }
  return {};
}

}  // namespace taxelsim::cli
