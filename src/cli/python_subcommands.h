// Subcommands that are written in Python, run by python3.
#pragma once

#include "cli/commands.h"

namespace taxelsim::cli {

// Lists them in the help of `app`. Their action throws Error(kInput): they are run by runInPython(), before arguments are parsed.
void addPythonSubcommands(CLI::App& app, Action& action);

// Replaces the process by python3, which runs the package with the same arguments, if they are a command of the package. Exits with status
// 2 if that is not installed. Throws Error(kInput) if there is no python3.
void runInPython(int argc, char** argv);

}  // namespace taxelsim::cli
