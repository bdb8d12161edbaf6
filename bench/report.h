// Statistics of repeated measurements, and the description of the machine in result files.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "taxelsim/device.h"

namespace taxelsim::bench {

// Starts when constructed.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Summary {
  double median = 0, min = 0, max = 0;
};

Summary summarise(std::vector<double> values);

// {median, min, max, all}
nlohmann::ordered_json toJson(const std::vector<double>& values);

// Device, driver, CPU, number of cores, program version, environment variables that change a driver.
nlohmann::ordered_json machine(const DeviceInfo& device);

// Calls `frame`, which waits for the device, until a GPU has left the clock frequency of its rest; does nothing on a processor.
void warmUp(const DeviceInfo& device, const std::function<void()>& frame);

// Runs a program's work. Returns its exit status: that of the work; 2 after bad input, 1 after another error, whose message it prints.
int exitStatus(const std::function<int()>& work);

void writeJson(const std::filesystem::path& file, const nlohmann::ordered_json& json);

}  // namespace taxelsim::bench
