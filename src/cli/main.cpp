// The command line: parses arguments, runs one subcommand, and reports an error as one line and an exit status.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/text.h"
#include "cli/commands.h"
#include "cli/memory_limit.h"
#include "cli/python_subcommands.h"
#include "cli/status_line.h"
#include "cli/usage_error.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim::cli {
namespace {

const std::map<std::string, spdlog::level::level_enum> kLogLevels{{"trace", spdlog::level::trace}, {"debug", spdlog::level::debug},
                                                                  {"info", spdlog::level::info},   {"warning", spdlog::level::warn},
                                                                  {"error", spdlog::level::err},   {"off", spdlog::level::off}};

// Prints the line and exits without cleanup: HDF5 1.10 prints its own errors at exit after it has read a broken file.
[[noreturn]] void fail(int status, const std::string& message) {
  std::fflush(stdout);
  std::fprintf(stderr, "taxelsim: %s\n", messageLine(message).c_str());
  std::fflush(stderr);
  std::_Exit(status);
}

int run(int argc, char** argv) {
  runInPython(argc, argv);
  CLI::App app{"Simulates arrays of tactile sensing elements on the GPU, thousands of sensors at once.", "taxelsim"};
  app.set_version_flag("--version", std::string("taxelsim ") + kVersion);
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "Examples:\n  taxelsim devices\n  taxelsim generate scenes/edge_servo.yaml -o out/ --episodes 1000\n"
      "See `taxelsim SUBCOMMAND --help`. Exit status: 0 success, 1 device or disk error, 2 bad input, 130 interrupted.");
  std::string log_level = "info";
  app.add_option("--log-level", log_level, "Level of log messages on stderr: trace, debug, info, warning, error or off")
      ->check(silent(CLI::IsMember(kLogLevels)))
      ->capture_default_str()
      ->type_name("LEVEL");

  Action action;
  addDevices(app, action);
  addFrame(app, action);
  addGenerate(app, action);
  addFinish(app, action);
  addInspect(app, action);
  addRender(app, action);
  addEvaluate(app, action);
  addExperiment(app, action);
  addCharacterize(app, action);
  addCompare(app, action);
  addCalibrateReadings(app, action);
  addStiffness(app, action);
  addRobot(app, action);
  addSchema(app, action);
  addPythonSubcommands(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    std::string where = "taxelsim";
    for (const CLI::App* chosen : app.get_subcommands()) where += " " + chosen->get_name();
    fail(kExitInput, usageMessage(app, {argv + 1, argv + argc}, error) + " (see " + where + " --help)");
  }
  const auto logger = std::make_shared<spdlog::logger>("taxelsim", makeLogSink());
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(kLogLevels.at(log_level));
  spdlog::set_default_logger(logger);  // registers it, so that the library logs to it
  return action();
}

}  // namespace

Failure currentFailure() {
  try {
    throw;
  } catch (const Error& error) {
    return {error.kind() == ErrorKind::kInput ? kExitInput : kExitDevice, error.what()};
  } catch (const std::bad_alloc&) {
    return {kExitDevice, "out of memory"};
  } catch (const std::length_error&) {  // a size that no memory has
    return {kExitDevice, "out of memory"};
  } catch (const std::system_error& error) {
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    return {kExitDevice, no_thread ? "cannot start a thread: out of memory, or too many processes" : error.what()};
  } catch (const std::exception& error) {
    return {kExitDevice, error.what()};
  }
}

}  // namespace taxelsim::cli

int main(int argc, char** argv) {
  using namespace taxelsim;
  using namespace taxelsim::cli;
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit becomes an error of write() instead of a signal
  explainCrashesUnderMemoryLimit();
  try {
    const int status = run(argc, argv);
    if (std::fflush(stdout) != 0) fail(kExitDevice, "cannot write to standard output");
    return status;
  } catch (const std::exception&) {
    const Failure failure = currentFailure();
    fail(failure.status, failure.message);
  }
}
