#include "report.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim::bench {
namespace {

std::string cpuName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace

Summary summarise(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {median, values.front(), values.back()};
}

nlohmann::ordered_json toJson(const std::vector<double>& values) {
  const Summary summary = summarise(values);
  return {{"median", summary.median}, {"min", summary.min}, {"max", summary.max}, {"all", values}};
}

nlohmann::ordered_json machine(const DeviceInfo& device) {
  nlohmann::ordered_json environment = nlohmann::ordered_json::object();
  for (const char* name : {"LP_NATIVE_VECTOR_WIDTH", "LP_NUM_THREADS", "VK_ICD_FILENAMES", "TAXELSIM_PLAIN", "TAXELSIM_VALIDATION"}) {
    // File names only: paths of a machine are irrelevant.
    if (const char* value = std::getenv(name)) environment[name] = std::filesystem::path(value).filename();
  }
  return {{"device", device.name},
          {"driver", device.driver},
          {"subgroup_size", device.subgroup_size},
          {"cpu", cpuName()},
          {"cores", std::thread::hardware_concurrency()},
          {"taxelsim", kVersion},
          {"environment", environment}};
}

void warmUp(const DeviceInfo& device, const std::function<void()>& frame) {
  // An H100 rests at 345 MHz, reaches its 1980 MHz within 0.5 s of full load, and loses them within 3 s without work.
  constexpr double kSeconds = 0.5;
  if (device.type == DeviceType::kCpu) return;
  const Stopwatch watch;
  while (watch.seconds() < kSeconds) frame();
}

int exitStatus(const std::function<int()>& work) {
  try {
    return work();
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.kind() == ErrorKind::kInput ? 2 : 1;
  }
}

void writeJson(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  std::ofstream out(file);
  out << json.dump(2) << '\n';
  if (!out.flush()) throw Error(ErrorKind::kIo, file.string() + ": cannot be written");
}

}  // namespace taxelsim::bench
