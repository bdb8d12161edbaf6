// Subcommands that are written in Python, run by python3. python/taxelsim/program.py has the same table.
#pragma once

#include "cli/commands.h"

namespace taxelsim::cli {

// Lists them in the help of `app`. Their action throws Error(kInput): they are run by runInPython(), before arguments are parsed.
void addPythonSubcommands(CLI::App& app, Action& action);

// Whether the command line is one of the Python package.
bool isPythonCommand(int argc, const char* const* argv);

// Replaces the process by python3, which runs the package with the same arguments, or exits with status 2 if it is not installed. Throws
// Error(kInput) if there is no python3.
[[noreturn]] void runInPython(int argc, char** argv);

}  // namespace taxelsim::cli
