#include "cli/python_subcommands.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
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

// Runs the package. argv[1] is what to say where it is not installed. `python3 -m` and `python3 -c` put the current folder first in the
// path; files of a stranger's data set must not replace modules.
constexpr const char* kStart = R"(import sys
sys.path[:] = filter(None, sys.path)
problem, sys.argv[:2] = sys.argv[1], ["taxelsim"]
from importlib.util import find_spec
if find_spec("taxelsim") is None:
    sys.exit(print(problem, file=sys.stderr) or 2)
from taxelsim.program import main
main())";

// An empty entry of PYTHONPATH is the current folder; "$PYTHONPATH:/x" has one where the variable was not set.
void removeEmptyEntries(const char* name) {
  const char* const value = std::getenv(name);
  if (value == nullptr) return;
  std::istringstream entries(value);
  std::string kept;
  for (std::string entry; std::getline(entries, entry, ':');)
    if (!entry.empty()) kept += (kept.empty() ? "" : ":") + entry;
  ::setenv(name, kept.c_str(), /*overwrite=*/1);
}

// Python prints a traceback for a signal that comes while it starts. The package takes the signal as soon as it is imported.
void blockInterrupts() {
  sigset_t interrupts;
  ::sigemptyset(&interrupts);
  ::sigaddset(&interrupts, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &interrupts, nullptr);
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
  const auto chosen = std::find_if(kPythonSubcommands.begin(), kPythonSubcommands.end(),
                                   [&](const PythonSubcommand& subcommand) { return isChosen(subcommand, argc, argv); });
  std::string subcommand = argv[1];
  if (const char* const* word = findWord(*chosen, argc, argv); word != argv + argc) subcommand += " " + std::string(*word);
  const std::string problem = messageLine(subcommand +
                                          " needs the Python package taxelsim, which python3 does not find: pip install . in a virtual "
                                          "environment (docs/python.md)");
  const std::string line = "taxelsim: " + problem;
  std::vector<const char*> words{"python3", "-c", kStart, line.c_str()};
  words.insert(words.end(), argv + 1, argv + argc);
  words.push_back(nullptr);
  removeEmptyEntries("PYTHONPATH");
  blockInterrupts();
  ::execvp(words[0], const_cast<char* const*>(words.data()));
  throw Error(ErrorKind::kInput, problem);
}

}  // namespace taxelsim::cli
