// Output of a sweep: table and JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sweep/case_run.h"

namespace taxelsim::bench {

struct CaseReport {
  SweepCase work;
  CaseResult result;
};

nlohmann::ordered_json toJson(const CaseReport& report);

// One row per case: batch, default and best time, gain.
void printTable(const std::vector<CaseReport>& reports);

// "sweep-<device>-<driver>", with letters, digits and dashes only.
std::string slugOf(const DeviceInfo& info);

// Reads the results of another sweep. Throws Error(kInput) for a file that is missing or not one.
nlohmann::ordered_json loadResults(const std::filesystem::path& file);

// Compares the case's hashes with those of another sweep: {inputs, tactile_image, floats}, each true or false, and the number of instances
// whose images differ; empty if the other sweep lacks the case.
nlohmann::ordered_json agreement(const CaseReport& report, const nlohmann::ordered_json& other);

// The same as one line of text.
std::string agreementText(const nlohmann::ordered_json& agreement);

}  // namespace taxelsim::bench
