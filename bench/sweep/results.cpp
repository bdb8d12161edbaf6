#include "sweep/results.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>

#include "report.h"
#include "sweep/trial.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Setting& setting) {
  Json json;
  for (std::size_t axis = 0; axis < kNumAxes; ++axis) json[axes()[axis].name] = setting[axis];
  return json;
}

// Times of a device without a clock are null.
Json toJson(const FrameTime& time) {
  return {{"contact", time.contact}, {"image", time.image}, {"device", time.device}, {"wall", time.wall}};
}

Json endOf(const CaseReport& report, const Setting& setting, const FrameTime& time) {
  return {{"setting", toJson(setting)},
          {"seconds", toJson(time)},
          {"us_per_frame", microsecondsPerFrame(report.result, time)},
          {"taxels_per_second", taxelsPerSecond(report.work, report.result, time)}};
}

std::string batchText(const CaseReport& report) {
  return std::to_string(report.result.num_instances) + (report.result.cut.empty() ? "" : "*");
}

}  // namespace

Json toJson(const CaseReport& report) {
  const auto& [work, result] = report;
  const GridPatch& patch = work.sensor.patches.at(0);
  Json json{{"case", work.name},
            {"num_rows", patch.num_rows},
            {"num_cols", patch.num_cols},
            {"samples_per_taxel", work.sensor.samples_per_taxel},
            {"object", work.object.name}};
  if (const Mesh* mesh = std::get_if<Mesh>(&work.object.shape)) json["num_triangles"] = mesh->triangles.size();
  json["num_instances"] = result.num_instances;
  if (!result.cut.empty()) json["fewer_instances"] = result.cut;
  json["without_force"] = result.without_force;
  json["chosen"] = endOf(report, result.chosen, result.chosen_time);
  json["best"] = endOf(report, result.best, result.best_time);
  json["gain"] = result.gain;
  if (!work.published.empty()) json["published"] = work.published;
  json["hashes"] = {{"num_instances", kChecked},
                    {"inputs", result.hashes.inputs},
                    {"tactile_image", result.hashes.tactile_image},
                    {"floats", result.hashes.floats},
                    {"instances", result.hashes.instances}};
  json["tried"] = Json::array();
  for (const Tried& tried : result.tried) {
    Json one{{"setting", toJson(tried.setting)}};
    if (tried.refused.empty()) one["seconds"] = toJson(tried.time);
    if (!tried.refused.empty()) one["refused"] = tried.refused;
    if (!tried.difference.empty()) one["differs_in"] = tried.difference;
    json["tried"].push_back(std::move(one));
  }
  return json;
}

void printTable(const std::vector<CaseReport>& reports) {
  std::printf("\n%-24s %9s %12s %12s %6s %12s %12s  %s\n", "case", "instances", "as chosen us", "best us", "gain", "wall us", "M taxels/s",
              "best setting");
  for (const CaseReport& report : reports) {
    const auto& [work, result] = report;
    std::printf("%-24s %9s %12.4g %12.4g %6.2f %12.4g %12.4g  %s\n", work.name.c_str(), batchText(report).c_str(),
                microsecondsPerFrame(result, result.chosen_time), microsecondsPerFrame(result, result.best_time), result.gain,
                result.best_time.wall / result.num_instances * 1e6, taxelsPerSecond(work, result, result.best_time) / 1e6,
                differenceText(result.best, result.chosen).c_str());
  }
  std::printf("us: of the device for one instance's frame; wall us: from step() to counts and features in hand, at best\n");
  for (const CaseReport& report : reports) {
    const auto refused =
        std::count_if(report.result.tried.begin(), report.result.tried.end(), [](const Tried& t) { return !t.refused.empty(); });
    if (refused > 0)
      std::printf("%s: the device refused %td of %zu settings\n", report.work.name.c_str(), refused, report.result.tried.size());
    if (!report.result.cut.empty()) std::printf("* %s: %s\n", report.work.name.c_str(), report.result.cut.c_str());
    if (!report.work.published.empty()) std::printf("%s: elsewhere, %s\n", report.work.name.c_str(), report.work.published.c_str());
  }
}

std::string slugOf(const DeviceInfo& info) {
  std::string slug = "sweep";
  bool dash = true;
  for (const char c : info.name + " " + info.driver) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (kept && dash) slug += '-';
    if (kept) slug += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    dash = !kept;
  }
  return slug;
}

Json loadResults(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw Error(ErrorKind::kInput, "--compare " + file.string() + ": cannot be read");
  Json json = Json::parse(in, nullptr, false);
  const bool good = json.is_object() && json.value("bench", Json()) == "sweep" && json.contains("cases") && json["cases"].is_array();
  if (!good) throw Error(ErrorKind::kInput, "--compare " + file.string() + ": not the results of a sweep");
  return json;
}

Json agreement(const CaseReport& report, const Json& other) {
  const Json own = toJson(report)["hashes"];
  for (const Json& theirs : other.at("cases")) {
    if (!theirs.is_object() || theirs.value("case", Json()) != report.work.name || !theirs.contains("hashes")) continue;
    Json agree;
    const Json& hashes = theirs["hashes"];
    for (const char* name : {"inputs", "tactile_image", "floats"}) agree[name] = hashes.value(name, Json()) == own[name];
    const Json images = hashes.value("instances", Json::array());
    int num_different = 0;
    for (std::size_t i = 0; i < own["instances"].size(); ++i) num_different += !(i < images.size() && images[i] == own["instances"][i]);
    agree["images_that_differ"] = num_different;
    return agree;
  }
  return {};
}

std::string agreementText(const Json& agreement) {
  if (agreement.is_null()) return "the other has no such case";
  std::string text;
  for (const char* name : {"inputs", "tactile_image", "floats"}) {
    text += (text.empty() ? "" : ", ") + std::string(name) + (agreement[name].get<bool>() ? " agree" : " DIFFER");
    if (name == std::string("tactile_image") && !agreement[name].get<bool>()) {
      text += " (" + std::to_string(agreement["images_that_differ"].get<int>()) + " of " + std::to_string(kChecked) + ")";
    }
  }
  return text;
}

}  // namespace taxelsim::bench
