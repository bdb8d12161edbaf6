// From a scene to a data set on disk: the batch scheduler behind `taxelsim generate`.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "taxelsim/dataset.h"
#include "taxelsim/device.h"
#include "taxelsim/progress.h"
#include "taxelsim/scene.h"

namespace taxelsim {

struct GenerateOptions {
  int batch_size = 2048;      // instances over all slices, >= 1; does not change a byte of the data set
  int num_slices = 2;         // slices of the batch in flight, >= 1; the same
  bool device_clock = false;  // whether GenerateTimes::device_busy is measured; SimulatorOptions::device_clock
  // Called a few times a second, by a thread of generate()'s own, and at the end, by the caller's. What it throws generate() throws.
  std::function<void(const Progress&)> on_progress{};
  // When it becomes true, shards under way are given up (complete ones stay) and generate() returns.
  const std::atomic<bool>* stop = nullptr;
};

// Where Progress::seconds went.
struct GenerateTimes {
  double device_busy = 0;   // s the device computed, by its own clock, which may be missing or not asked for: NaN
  double device_wait = 0;   // s the thread with scheduler and controllers waited for the device
  double writer_wait = 0;   // s it waited for the writer's: shards under way filled the memory set aside for them
  double writing_last = 0;  // s from the last frame until the last shard was on disk
};

struct GenerateResult {
  Progress progress;
  GenerateTimes times;
  bool complete = false;              // false when stopped
  std::uint64_t num_load_misses = 0;  // contacts whose load was out of reach (also a column of the data set)
};

// The columns that a scene records, in file order.
std::vector<Column> columnsOf(const Scene& scene);

// Simulates all episodes of the scene that the directory lacks and writes them. Waits. Throws what Model, Simulator and
// DatasetWriter throw.
GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory,
                        const GenerateOptions& options = {});

}  // namespace taxelsim
