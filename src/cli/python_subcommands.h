// Subcommands that are written in Python, run as `python3 -m taxelsim`. python/taxelsim/program.py has the same table.
#pragma once

#include "cli/commands.h"

namespace taxelsim::cli {

// Lists them in the help of `app`. Their action throws Error(kInput): they are run by runInPython(), before arguments are parsed.
void addPythonSubcommands(CLI::App& app, Action& action);

// Whether the command line is one of the Python package.
bool isPythonCommand(int argc, const char* const* argv);

// Replaces the process by `python3 -m taxelsim` with the same arguments. Throws Error(kInput) if the package is not installed.
[[noreturn]] void runInPython(int argc, char** argv);

}  // namespace taxelsim::cli
