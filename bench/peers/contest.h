// One case: the peers are made, verified against taxelsim, warmed up, timed in turns.
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
  int threads = 0;                 // of every peer; 0: one per core
  std::vector<std::string> peers;  // by name; taxelsim always runs
};

struct PeerResult {
  std::string name, what;
  std::size_t num_instances = 0;         // timed; fewer than the case has where more would take long
  std::optional<Agreement> agreement{};  // with taxelsim; of itself none
  std::vector<double> seconds{};         // (repetitions); empty: it did not agree, and was not timed
  std::vector<double> ratios{};          // (repetitions): seconds per frame over taxelsim's in the same turn

  double framesPerSecond() const { return static_cast<double>(num_instances) / summarise(seconds).median; }
};

struct CaseResult {
  std::string name, note, array;
  std::size_t num_instances = 0, num_triangles = 0;
  double load_seconds = 0, touched = 0;                      // fraction of the taxels under contact
  std::vector<PeerResult> peers;                             // taxelsim first
  std::vector<double> submit_to_read, device, contact_pass;  // s, of taxelsim
  bool complete = true;                                      // everybody who computes the same frame agreed
};

// All names that ContestOptions::peers may have, taxelsim's apart, in the order of the table.
std::vector<std::string> peerNames();
// Why a peer of this name is not in the program; empty when it is.
std::string missingPeer(const std::string& name);

// Throws what Model and Simulator throw.
CaseResult runCase(const Device& device, const Sensor& sensor, const Case& work, const ContestOptions& options);

void print(const CaseResult& result);
nlohmann::ordered_json toJson(const CaseResult& result);

}  // namespace taxelsim::bench
