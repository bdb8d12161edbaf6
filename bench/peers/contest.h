// Runs one case: makes the peers, verifies them against taxelsim, warms up, times all in turns.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "peers/agreement.h"
#include "peers/cases.h"
#include "report.h"
#include "taxelsim/device.h"

namespace taxelsim::bench {

struct ContestOptions {
  int repetitions = 7;
  int threads = 0;                 // of every peer; 0 (default): one per core
  std::vector<std::string> peers;  // names, in addition to taxelsim
};

struct PeerResult {
  std::string name, what;
  std::size_t num_instances = 0;         // timed; fewer than those of the case if the peer is slow
  std::optional<Agreement> agreement{};  // with taxelsim; none for taxelsim
  std::vector<double> seconds{};         // s, (repetitions), per frame of the batch; empty if the peer disagrees and was not timed
  std::vector<double> ratios{};          // (repetitions): its seconds per instance over those of taxelsim in the same turn

  double framesPerSecond() const { return static_cast<double>(num_instances) / summarise(seconds).median; }
};

struct CaseResult {
  std::string name, note, array;
  std::size_t num_instances = 0, num_triangles = 0;
  double load_seconds = 0, touched = 0;                      // s; fraction of the taxels under contact
  std::vector<PeerResult> peers;                             // taxelsim first
  std::vector<double> submit_to_read, device, contact_pass;  // s, of taxelsim
  bool complete = true;                                      // whether all peers that compute the same frame agree
};

// Names of all peers, without taxelsim, in the order of the table.
std::vector<std::string> peerNames();
// Why the program was built without this peer; empty if it has it.
std::string missingPeer(const std::string& name);

// A peer that cannot take the case is left out; the note says why. Throws what Model and Simulator throw.
CaseResult runCase(const Device& device, const Sensor& sensor, const Case& work, const ContestOptions& options);

void print(const CaseResult& result);
nlohmann::ordered_json toJson(const CaseResult& result);

}  // namespace taxelsim::bench
