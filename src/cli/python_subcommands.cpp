#include "cli/python_subcommands.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

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

bool isPythonCommand(int argc, const char* const* argv) {
  if (argc < 2 || argv[1] != std::string_view("evaluate")) return false;
  return std::any_of(argv + 2, argv + argc, [](std::string_view word) { return word.substr(0, word.find('=')) == "--policy"; });
}

void runInPython(int argc, char** argv) {
  if (hasPackage()) {
    std::vector<const char*> words{"python3", "-m", "taxelsim"};
    words.insert(words.end(), argv + 1, argv + argc);
    words.push_back(nullptr);
    ::execvp(words[0], const_cast<char* const*>(words.data()));
  }
  throw Error(ErrorKind::kInput,
              "evaluate --policy needs the Python package taxelsim, which python3 does not find: pip install . in a virtual environment "
              "(docs/python.md)");
}

}  // namespace taxelsim::cli
