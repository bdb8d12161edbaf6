#include "cli/python_subcommands.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

struct PythonSubcommand {
  const char* name;
  // With one of these words only: an option, or the end of a file name. None: always.
  std::array<std::string_view, 2> words;
  const char* description;  // empty if the subcommand exists in C++ as well
};

constexpr std::array kPythonSubcommands{
    PythonSubcommand{.name = "evaluate", .words = {"--policy"}, .description = ""},
    PythonSubcommand{.name = "finish", .words = {"--card"}, .description = ""},
    PythonSubcommand{.name = "render", .words = {".mp4", ".gif"}, .description = ""},
    PythonSubcommand{.name = "report", .words = {}, .description = "Write a data set as a page of HTML, or its card"},
    PythonSubcommand{.name = "view", .words = {}, .description = "Show episodes of a data set or a scene in the viewer Rerun"},
    PythonSubcommand{.name = "export", .words = {}, .description = "Write a data set for LeRobot, Zarr, robomimic or ROS 2"},
    PythonSubcommand{.name = "import", .words = {}, .description = "Make a measurement from a recording: CSV, LeRobot"},
};

bool isMatch(std::string_view argument, std::string_view word) {
  return !word.empty() && (word.starts_with('.') ? argument.ends_with(word) : argument.substr(0, argument.find('=')) == word);
}

// The argument that one of the subcommand's words matches; argv + argc without.
const char* const* findWord(const PythonSubcommand& subcommand, int argc, const char* const* argv) {
  return std::find_if(argv + 2, argv + argc, [&](std::string_view argument) {
    return std::any_of(subcommand.words.begin(), subcommand.words.end(), [&](std::string_view word) { return isMatch(argument, word); });
  });
}

// Whether the first word of the command line names it, with one of its words.
bool isChosen(const PythonSubcommand& subcommand, int argc, const char* const* argv) {
  return argc >= 2 && argv[1] == std::string_view(subcommand.name) &&
         (subcommand.words[0].empty() || findWord(subcommand, argc, argv) != argv + argc);
}

// Exit status 0 if python3 finds the package.
bool hasPackage() {
  const char* const probe[] = {"python3", "-c", "import importlib.util, sys\nsys.exit(importlib.util.find_spec('taxelsim') is None)",
                               nullptr};
  posix_spawn_file_actions_t quiet;
  ::posix_spawn_file_actions_init(&quiet);
  ::posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, probe[0], &quiet, nullptr, const_cast<char* const*>(probe), environ);
  ::posix_spawn_file_actions_destroy(&quiet);
  int status = 0;
  return error == 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

void addPythonSubcommands(CLI::App& app, Action& action) {
  for (const PythonSubcommand& subcommand : kPythonSubcommands) {
    if (*subcommand.description == '\0') continue;
    CLI::App* const sub = app.add_subcommand(subcommand.name, subcommand.description)->allow_extras();
    sub->callback([&action, name = subcommand.name] {
      action = [name]() -> int { throw Error(ErrorKind::kInput, std::string(name) + ": must be the first word after taxelsim"); };
    });
  }
}

bool isPythonCommand(int argc, const char* const* argv) {
  return std::any_of(kPythonSubcommands.begin(), kPythonSubcommands.end(),
                     [&](const PythonSubcommand& subcommand) { return isChosen(subcommand, argc, argv); });
}

void runInPython(int argc, char** argv) {
  if (hasPackage()) {
    std::vector<const char*> words{"python3", "-m", "taxelsim"};
    words.insert(words.end(), argv + 1, argv + argc);
    words.push_back(nullptr);
    ::execvp(words[0], const_cast<char* const*>(words.data()));
  }
  const auto chosen = std::find_if(kPythonSubcommands.begin(), kPythonSubcommands.end(),
                                   [&](const PythonSubcommand& subcommand) { return isChosen(subcommand, argc, argv); });
  std::string words = argv[1];
  if (const char* const* word = findWord(*chosen, argc, argv); word != argv + argc) words += " " + std::string(*word);
  throw Error(ErrorKind::kInput, words +
                                     " needs the Python package taxelsim, which python3 does not find: pip install . in a virtual "
                                     "environment (docs/python.md)");
}

}  // namespace taxelsim::cli
