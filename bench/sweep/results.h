// What a sweep writes and prints.
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

// One row a case: batch, time as the device chooses and at best, what both give.
void printTable(const std::vector<CaseReport>& reports);

// "sweep-<device>-<driver>", of letters, digits and dashes.
std::string slugOf(const DeviceInfo& info);

// The results of another sweep. Throws Error(kInput) for a file that is not there or holds none.
nlohmann::ordered_json loadResults(const std::filesystem::path& file);

// Which of the case's hashes agree with those of another sweep: {inputs, tactile_image, floats}, each true or false, and of how many
// instances the images differ; empty where the other has no such case.
nlohmann::ordered_json agreement(const CaseReport& report, const nlohmann::ordered_json& other);

// The same in words, a line.
std::string agreementText(const nlohmann::ordered_json& agreement);

}  // namespace taxelsim::bench
