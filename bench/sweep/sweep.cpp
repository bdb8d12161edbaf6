// Measures a device under other workgroup sizes, teams and repeats than its defaults, and checks that the output bits stay the same. Needs
// only the Vulkan loader and the C++ runtime, so that it can be copied to a machine with a GPU and little else.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "report.h"
#include "sweep/results.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

struct Options {
  std::vector<std::string> cases, axes;
  std::string json, results, compare, device;
  int most_instances = 0;
  int repetitions = 15;
  bool quick = false;
};

// A minute on two cores of software Vulkan: small batches, every fourth size, one round.
constexpr int kQuickInstances = 64;
constexpr int kQuickRepetitions = 5;
const std::vector<std::string> kQuickCases{"wts0614_cylinder", "wts0614_ellipsoid_5120", "10x10"};

std::vector<std::vector<int>> everySecond() {
  std::vector<std::vector<int>> some;
  for (const Axis& axis : axes()) {
    some.emplace_back();
    for (std::size_t k = 0; k < axis.values.size(); k += 2) some.back().push_back(axis.values[k]);
  }
  return some;
}

CaseOptions caseOptions(const Options& options) {
  CaseOptions of;
  of.descent.over = axesNamed(options.axes);
  of.most_instances = options.most_instances;
  of.repetitions = options.repetitions;
  if (options.quick) {
    of.descent.rounds = 1;
    of.descent.only = everySecond();
    of.repetitions = std::min(options.repetitions, kQuickRepetitions);
    of.most_instances = options.most_instances > 0 ? options.most_instances : kQuickInstances;
  }
  return of;
}

// Objects rest, but their meshes must be culled in every frame.
void cullAlways() {
  constexpr const char* kName = "TAXELSIM_PLAIN";
  const char* before = std::getenv(kName);
  ::setenv(kName, (std::string("candidates,") + (before == nullptr ? "" : before)).c_str(), 1);
}

// Returns whether all settings of every case gave the same bits.
bool run(const Options& options) {
  const std::vector<SweepCase> cases = casesNamed(options.quick && options.cases.empty() ? kQuickCases : options.cases);
  const CaseOptions case_options = caseOptions(options);
  cullAlways();
  nlohmann::ordered_json other;
  if (!options.compare.empty()) other = loadResults(options.compare);
  const Device device = Device::open({.device = options.device, .keep_kernels = false});
  const DeviceInfo& info = device.info();
  std::filesystem::path file = options.json;
  if (!options.results.empty()) file = std::filesystem::path(options.results) / (slugOf(info) + ".json");
  std::printf("%s, %s; %d repetitions\n", info.name.c_str(), info.driver.c_str(), case_options.repetitions);
  nlohmann::ordered_json json{{"bench", "sweep"},
                              {"machine", machine(info)},
                              {"memory", info.memory},
                              {"max_buffer", info.max_buffer},
                              {"shared_memory", info.shared_memory},
                              {"quick", options.quick},
                              {"repetitions", case_options.repetitions},
                              {"cases", nlohmann::ordered_json::array()}};
  const auto write = [&] {
    if (!file.empty()) writeJson(file, json);
  };
  write();  // fails before the measurement if the file cannot be written
  std::vector<CaseReport> reports;
  bool all_equal = true;
  for (const SweepCase& work : cases) {
    const auto progress = [&](const std::string& line) { std::fprintf(stderr, "%s: %s\n", work.name.c_str(), line.c_str()); };
    progress("making it ready");
    const CaseReport& report = reports.emplace_back(CaseReport{work, runCase(device, work, case_options, progress)});
    for (const Tried& tried : report.result.tried) all_equal = all_equal && tried.difference.empty();
    json["cases"].push_back(toJson(report));
    if (!options.compare.empty()) json["cases"].back()["agreement"] = agreement(report, other);
    write();  // after each case, so that an aborted sweep keeps its results
  }
  printTable(reports);
  for (const CaseReport& report : reports) {
    const OutputHashes& hashes = report.result.hashes;
    std::printf("%s: tactile_image %.16s, floats %.16s", report.work.name.c_str(), hashes.tactile_image.c_str(), hashes.floats.c_str());
    std::printf("%s\n", options.compare.empty() ? "" : ("; " + agreementText(agreement(report, other))).c_str());
    for (const Tried& tried : report.result.tried) {
      if (tried.difference.empty()) continue;
      std::printf("%s: with %s the bits differ in %s\n", report.work.name.c_str(),
                  differenceText(tried.setting, report.result.chosen).c_str(), tried.difference.c_str());
    }
  }
  std::printf("%s\n", all_equal ? "every setting gave the same bits" : "NOT every setting gave the same bits");
  if (!file.empty()) std::printf("written: %s\n", file.c_str());
  return all_equal;
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Measures a device under other workgroup sizes, teams and repeats, and checks that the output bits stay the same");
  app.add_option("--cases", options.cases, "Cases, separated by commas; default all")->delimiter(',');
  app.add_option("--axes", options.axes,
                 "What to turn: contact_workgroup, contact_repeat, groups_per_batch, image_workgroup, image_team, image_repeat")
      ->delimiter(',');
  app.add_option("--instances", options.most_instances, "Largest batch")->check(CLI::Range(1, 1 << 20));
  app.add_option("--repetitions", options.repetitions, "Timed frames per setting")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_flag("--quick", options.quick, "A minute on two CPU cores: three small cases, every second value, one round");
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  app.add_option("--compare", options.compare, "JSON file of another sweep: reports which output hashes agree");
  CLI::Option* json = app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--results", options.results, "Write the results to this folder, in a file named after device and driver")
      ->check(CLI::ExistingDirectory)
      ->excludes(json);
  try {
    app.parse(argc, argv);
    return taxelsim::bench::run(options) ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    std::fprintf(stderr, "sweep: %s (see sweep --help)\n", error.what());
    return 2;
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "sweep: %s\n", error.what());
    return error.kind() == taxelsim::ErrorKind::kInput ? 2 : 1;
  } catch (const std::exception& error) {  // no Vulkan loader, no memory
    std::fprintf(stderr, "sweep: %s\n", error.what());
    return 1;
  }
}
