// Compares the frame rate of taxelsim with that of other programs on the same poses and taxels, in one process. All are verified against
// each other first, then timed in turns, so that other load on the machine affects all of them. Quote the ratios.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "peers/bar_chart.h"
#include "peers/batch_sizes.h"
#include "peers/cases.h"
#include "peers/contest.h"
#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

// The largest batch of a sweep, in taxels: 4096 arrays of 100 x 100.
constexpr std::size_t kMostTaxels = std::size_t{4096} * 10000;

struct Options {
  std::string sensor = TAXELSIM_BENCH "/sensors/wts0614.yaml";
  std::string json, plot, device;
  std::vector<std::string> arrays, cases, peers;
  std::vector<int> instances;
  bool sweep = false, batches = false;
  ContestOptions contest;
};

// Fills in the defaults of the kind of run.
Options withDefaults(Options options) {
  const auto byDefault = [](auto& values, auto defaults) {
    if (values.empty()) values = std::move(defaults);
  };
  if (options.sweep) {
    byDefault(options.cases, std::vector<std::string>{"ellipsoid_5120"});
    byDefault(options.arrays, std::vector<std::string>{"6x14", "10x10", "100x100"});
    byDefault(options.instances, std::vector<int>{64, 256, 1024, 4096, 16384, 65536});
    byDefault(options.peers, std::vector<std::string>{"embree", "embree_box"});
  }
  if (options.batches) {
    byDefault(options.cases, std::vector<std::string>{"ellipsoid_5120"});
    byDefault(options.instances, std::vector<int>{64, 512, 1024, 2048, 4096, 16384, 65536});
  }
  byDefault(options.cases, caseNames());
  byDefault(options.arrays, std::vector<std::string>{"6x14"});
  byDefault(options.instances, std::vector<int>{4096});
  byDefault(options.peers, peerNames());
  return options;
}

void checkNames(const Options& options) {
  const auto check = [](const char* option, const std::vector<std::string>& given, const std::vector<std::string>& known) {
    for (const std::string& name : given) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      std::string list;
      for (const std::string& other : known) list += (list.empty() ? "" : ", ") + other;
      throw Error(ErrorKind::kInput, std::string(option) + " " + name + ": not one of " + list);
    }
  };
  check("--case", options.cases, caseNames());
  check("--peers", options.peers, peerNames());
}

// Throws before the run if the folder of an output file is missing.
void checkFolder(const char* option, const std::string& file) {
  if (file.empty()) return;
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  if (!std::filesystem::is_directory(folder))
    throw Error(ErrorKind::kInput, std::string(option) + " " + file + ": there is no such folder");
}

// Compares batch sizes on every case and array.
nlohmann::ordered_json runBatchSizes(const Device& device, CaseMaker& maker, const std::vector<Sensor>& sensors, const Options& options) {
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  const int largest = *std::max_element(options.instances.begin(), options.instances.end());
  for (const std::string& name : options.cases) {
    for (const Sensor& sensor : sensors) {
      const BatchSizes result =
          timeBatchSizes(device, sensor, maker.make(name, sensor, largest), options.instances, options.contest.repetitions);
      print(result);
      results.push_back(toJson(result));
    }
  }
  return results;
}

// Runs all cases, arrays and batches; prints each result.
std::vector<CaseResult> runCases(const Device& device, CaseMaker& maker, const std::vector<Sensor>& sensors, const Options& options) {
  std::vector<CaseResult> results;
  for (const std::string& name : options.cases) {
    for (std::size_t a = 0; a < sensors.size(); ++a) {
      for (const int num_instances : options.instances) {
        const std::string where = name + ", " + options.arrays[a] + " taxels, " + std::to_string(num_instances) + " instances";
        if (static_cast<std::size_t>(num_instances) * static_cast<std::size_t>(numTaxels(sensors[a])) > kMostTaxels) {
          std::printf("%s: left out, larger than %zu taxels\n\n", where.c_str(), kMostTaxels);
          continue;
        }
        const Case work = maker.make(name, sensors[a], num_instances);
        try {
          results.push_back(runCase(device, sensors[a], work, options.contest));
        } catch (const Error& error) {
          // A sweep continues after a batch that does not fit on the device.
          if (!options.sweep) throw;
          std::printf("%s: left out, %s\n\n", where.c_str(), error.what());
          continue;
        }
        print(results.back());
      }
    }
  }
  return results;
}

// Prints why peers are missing from this build.
nlohmann::ordered_json missingPeers(const std::vector<std::string>& names) {
  nlohmann::ordered_json reasons = nlohmann::ordered_json::array();
  for (const std::string& name : names) {
    const std::string reason = missingPeer(name);
    if (reason.empty()) continue;
    std::printf("%s\n", reason.c_str());
    reasons.push_back(reason);
  }
  return reasons;
}

int run(const Options& given) {
  Options options = withDefaults(given);
  checkNames(options);
  checkFolder("--json", options.json);
  checkFolder("--plot", options.plot);
  const nlohmann::ordered_json left_out = missingPeers(options.peers);
  options.contest.peers = options.peers;
  const Sensor sensor = loadSensor(options.sensor);
  std::vector<Sensor> sensors;
  for (const std::string& array : options.arrays) sensors.push_back(withArray(sensor, array));
  const Device device = Device::open({.device = options.device});
  const nlohmann::ordered_json where = machine(device.info());
  const std::string heading = device.info().name + ", " + device.info().driver + "; peers on " + where["cpu"].get<std::string>() + ", " +
                              std::to_string(where["cores"].get<unsigned>()) + " cores";
  std::printf("%s\n%s, %d repetitions\n\n", heading.c_str(), sensor.name.c_str(), options.contest.repetitions);

  CaseMaker maker(TAXELSIM_SCENES "/objects");
  nlohmann::ordered_json json{{"bench", options.batches ? "peers --batches"
                                        : options.sweep ? "peers --sweep"
                                                        : "peers"},
                              {"machine", where},
                              {"sensor", sensor.name},
                              {"repetitions", options.contest.repetitions}};
  if (options.batches) {
    json["cases"] = runBatchSizes(device, maker, sensors, options);
    if (!options.json.empty()) writeJson(options.json, json);
    return 0;
  }
  const std::vector<CaseResult> results = runCases(device, maker, sensors, options);
  json["threads"] = options.contest.threads;
  json["left_out"] = left_out;
  json["cases"] = nlohmann::ordered_json::array();
  bool complete = true;
  for (const CaseResult& result : results) {
    json["cases"].push_back(toJson(result));
    complete &= result.complete;
  }
  if (!options.json.empty()) writeJson(options.json, json);
  if (!options.plot.empty()) writeBarChart(options.plot, heading, results);
  return complete ? 0 : 1;
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  using namespace taxelsim;
  bench::Options options;
  CLI::App app("Compares the frame rate of taxelsim with other programs: same poses and taxels, verified, timed in turns");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--plot", options.plot, "Plot the results to this PNG file");
  app.add_option("--case", options.cases, "Cases, separated by commas; default all")->delimiter(',');
  app.add_option("--peers", options.peers, "Peers, separated by commas; default all")->delimiter(',');
  app.add_option("--array", options.arrays, "Arrays, rows x columns as in 6x14, separated by commas")->delimiter(',');
  app.add_option("--instances", options.instances, "Batch sizes, separated by commas; default 4096")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20));
  app.add_flag("--sweep", options.sweep,
               "Batches of 64 to 65,536, arrays of 6x14, 10x10 and 100x100, one case, peers embree and embree_box");
  app.add_flag("--batches", options.batches, "Scaling: the same frames in batches of 64 to 65,536, in turns; no peers")
      ->excludes("--sweep")
      ->excludes("--peers")
      ->excludes("--plot");
  app.add_option("--repetitions", options.contest.repetitions, "Timed repetitions")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--threads", options.contest.threads, "Threads of every peer on the CPU; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--sensor", options.sensor, "Sensor file")->capture_default_str();
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "peers: %s\n", error.what());
    return 2;
  }
  try {
    return bench::run(options);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.kind() == ErrorKind::kInput ? 2 : 1;
  }
}
