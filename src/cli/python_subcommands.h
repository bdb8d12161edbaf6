// Subcommands that are written in Python, run as `python3 -m taxelsim`.
#pragma once

namespace taxelsim::cli {

// Whether the command line is one of the Python package: `evaluate` with --policy.
bool isPythonCommand(int argc, const char* const* argv);

// Replaces the process by `python3 -m taxelsim` with the same arguments. Throws Error(kInput) if the package is not installed.
[[noreturn]] void runInPython(int argc, char** argv);

}  // namespace taxelsim::cli
