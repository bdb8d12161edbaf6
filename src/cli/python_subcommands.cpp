#include "cli/python_subcommands.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "base/text.h"
#include "cli/python_table.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

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

void runInPython(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  const std::string command = pythonCommand(arguments);
  if (command.empty()) return;
  const std::string problem = messageLine(command +
                                          " needs the Python package taxelsim, which python3 does not find: pip install . in a virtual "
                                          "environment (docs/reference/python.md)");
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
