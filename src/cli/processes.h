// --processes of the commands whose episodes several processes of this machine can share: forks of the program, which the first process
// watches. They end with it.
#pragma once

#include <CLI/App.hpp>
#include <atomic>
#include <cassert>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "taxelsim/progress.h"

namespace taxelsim::cli {

// Adds the option; `num_processes` must outlive the parsing.
void addProcessesOption(CLI::App& command, int& num_processes);

// Processes that work of so many parts can use, at least 1: at most as many as requested.
int usableProcesses(int num_requested, std::uint64_t num_parts);

// Instances of a batch that each of the processes simulates, at least 1.
int batchShare(int batch_size, int num_processes);

// The side of one of the processes.
struct Process {
  int number;                     // from 0; only the first one logs information and warnings
  const std::atomic<bool>& stop;  // true once all shall stop
  std::function<void(const Progress&)> report;
};

// Adds the progress of another process.
void add(Progress& sum, const Progress& more);

using Work = std::function<std::string(const Process&)>;

// Does the work in each of so many new processes and returns what it returned there, by number. Shows their progress in one line. SIGINT
// and SIGTERM are those of stopOnSignals(); the processes learn of them by Process::stop.
//
// If a process fails or is killed, stops the others and throws Error, which names the process unless the input is at fault. Call it in a
// program without other threads, before a device is open: the processes begin as copies of this one.
std::vector<std::string> forkProcesses(int num_processes, const Work& work);

// The same, but without a new process for a single one.
std::vector<std::string> runProcesses(int num_processes, const Work& work);

// Appends plain values to a result, and takes them from its start.
template <class T>
void putValues(std::string& result, std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  result.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

template <class T>
std::vector<T> takeValues(std::string_view& result, std::size_t num_values) {
  static_assert(std::is_trivially_copyable_v<T>);
  assert(result.size() >= num_values * sizeof(T));
  std::vector<T> values(num_values);
  std::memcpy(values.data(), result.data(), num_values * sizeof(T));
  result.remove_prefix(num_values * sizeof(T));
  return values;
}

}  // namespace taxelsim::cli
