/// @file
/// From a scene to a data set on disk: the batch scheduler behind `taxelsim generate`.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "taxelsim/contact_misses.h"
#include "taxelsim/dataset.h"
#include "taxelsim/device.h"
#include "taxelsim/policy.h"
#include "taxelsim/progress.h"
#include "taxelsim/scene.h"

namespace taxelsim {

/// Options of generate(). The others than `policy` and `episodes` do not change a byte of a shard.
struct GenerateOptions {
  int batch_size = 2048;      ///< Instances over all slices, >= 1. Default 2048.
  int num_slices = 2;         ///< Slices of the batch in flight at once, >= 1. Default 2.
  bool device_clock = false;  ///< Whether to measure GenerateTimes::device_busy; see SimulatorOptions::device_clock. Default false.
  /// Called a few times a second from the thread of generate()'s scheduler, and once at the end from the caller's thread. An exception that
  /// it throws ends generate() and is thrown by it. Default: none.
  std::function<void(const Progress&)> on_progress{};
  /// Whether to make damaged and foreign shards again; see DatasetWriterOptions::repair. Default false.
  bool repair = false;
  /// Makes these shards only, in a directory that other processes may write at the same time with the same scene, program version and kind
  /// of device; see DatasetWriterOptions::shards. finishDataset() completes the data set. Default: none, the whole data set by this
  /// process.
  std::optional<ShardRange> shards{};
  /// Processes of this machine that make shards at the same time, with this one, >= 1. Each takes its part of the memory and the
  /// processors, and the caller warns of their contact_misses together. Default 1.
  int num_processes = 1;
  /// Called while the shards on disk are verified; see DatasetWriterOptions::on_verify. Default: none.
  std::function<void(std::uint64_t num_verified, std::uint64_t num_shards)> on_verify{};
  /// Graceful stop: when *stop becomes true, generate() abandons unfinished shards, keeps complete ones, and returns. May be set from any
  /// thread. Not owned; must outlive the call. Default: none.
  const std::atomic<bool>* stop = nullptr;
  /// Policy that acts instead of the scene's controllers. The manifest stores its id; meta/controller is -1. Default: none.
  std::optional<Policy> policy{};
  /// Numbers of the episodes of the data set, in the order of its rows, instead of 0 to Scene::num_episodes - 1; all different. Such a data
  /// set cannot grow. Default: empty, all episodes of the scene.
  std::vector<std::uint64_t> episodes{};
};

/// Where the time of a run went.
struct GenerateTimes {
  double device_busy = 0;   ///< s that the device computed, by its own clock; NaN if it has none or it was not requested.
  double device_wait = 0;   ///< s that the scheduler's thread waited for the device.
  double writer_wait = 0;   ///< s that it waited for the writer's thread because unfinished shards filled their memory.
  double writing_last = 0;  ///< s from the last frame until the last shard was on disk.
};

/// Episodes of one object whose load was out of reach: the skin could not carry it, so they begin with the deepest contact.
struct LoadMisses {
  std::uint64_t num_episodes = 0;  ///< Episodes with the object that this run simulated.
  std::uint64_t num_misses = 0;    ///< Those whose load was out of reach.
  /// N, smallest and largest force of the deepest contact over the misses: the load that the object could carry there. 0 without misses.
  std::array<float, 2> carried{0, 0};
};

/// Result of generate().
struct GenerateResult {
  Progress progress;                    ///< Progress at the end; its episodes are those of GenerateOptions::shards.
  GenerateTimes times;                  ///< Where the time went.
  bool complete = false;                ///< Whether all requested shards are on disk; false after a stop.
  bool verified = true;                 ///< Whether all shards on disk were verified; false after a stop before that.
  std::uint64_t num_load_misses = 0;    ///< Contacts whose load was out of reach; also a column of the data set.
  std::vector<LoadMisses> load_misses;  ///< (num_objects), the same by object.
  /// (num_fingers) of a scene of kind grasp, else (1): episodes without contact. generate() logs a warning if there are any and it
  /// is the only process.
  std::vector<ContactMisses> contact_misses;
};

/// The columns that a scene records, in file order.
std::vector<Column> columnsOf(const Scene& scene);

/// Simulates and writes all episodes of the scene that `directory` lacks. Blocks until they are on disk or *stop is true. Shards that
/// another process has claimed are awaited, and made here if that process ends without them.
///
/// First computes a probe, a few frames. A data set whose probe has other values is refused, since this machine would continue it with
/// values that the other one does not compute.
///
/// Resumes or extends a data set that is already there, but not one of another policy. The bytes depend on the scene, the seed, the device
/// and the policy only. Throws what Model, Simulator, DatasetWriter and the policy throw, and Error(kInput) for options out of range, a
/// batch that does not fit into memory, and a policy without id or that cannot act in the scene.
///
/// Threads: may be called from several threads at once, with different directories or with GenerateOptions::shards. It simulates in one
/// thread of its own and writes in others.
GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory,
                        const GenerateOptions& options = {});

}  // namespace taxelsim
