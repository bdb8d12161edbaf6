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
  std::string_view option;  // with this option only; empty: always
  const char* description;  // empty if the subcommand exists in C++ as well
};

constexpr std::array kPythonSubcommands{
    PythonSubcommand{.name = "evaluate", .option = "--policy", .description = ""},
    PythonSubcommand{.name = "report", .option = "", .description = "Write a data set as a page of HTML, or its card"},
    PythonSubcommand{.name = "view", .option = "", .description = "Show episodes of a data set or a scene in the viewer Rerun"},
    PythonSubcommand{.name = "export", .option = "", .description = "Write a data set for LeRobot, Zarr, robomimic or ROS 2"},
    PythonSubcommand{.name = "import", .option = "", .description = "Make a measurement from a recording: CSV, LeRobot"},
};

// Whether the first word of the command line names it, with its option.
bool isChosen(const PythonSubcommand& subcommand, int argc, const char* const* argv) {
  const auto isOption = [&](std::string_view word) { return word.substr(0, word.find('=')) == subcommand.option; };
  return argc >= 2 && argv[1] == std::string_view(subcommand.name) &&
         (subcommand.option.empty() || std::any_of(argv + 2, argv + argc, isOption));
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
  if (!chosen->option.empty()) words += " " + std::string(chosen->option);
  throw Error(ErrorKind::kInput, words +
                                     " needs the Python package taxelsim, which python3 does not find: pip install . in a virtual "
                                     "environment (docs/python.md)");
}

}  // namespace taxelsim::cli
