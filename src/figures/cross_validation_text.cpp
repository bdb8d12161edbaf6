#include "figures/cross_validation_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "figures/text.h"

namespace taxelsim::figures {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

// Loads that are scored together.
struct LoadClass {
  std::string name;
  double from = 0, to = kAll;  // N
};

std::vector<LoadClass> classesOf(const CrossValidation& result, double light_below) {
  const auto has = [&](const LoadClass& loads) {
    const std::vector<PredictionScore>& scores = result.predictors.front().scores;
    return std::any_of(scores.begin(), scores.end(), [&](const auto& score) { return score.load >= loads.from && score.load < loads.to; });
  };
  if (!(light_below > 0)) return {{.name = ""}};
  std::vector<LoadClass> classes{{.name = fmt::format(" below {:.4g} N", light_below), .from = 0, .to = light_below},
                                 {.name = fmt::format(" from {:.4g} N up", light_below), .from = light_below, .to = kAll}};
  std::erase_if(classes, [&](const LoadClass& loads) { return !has(loads); });
  return classes;
}

bool hasScores(const CrossValidation& result) {
  return !result.predictors.front().scores.empty();
}

struct Metric {
  const char* name;
  double PredictionScore::*value;
};
constexpr Metric kJudged[] = {{"M4", &PredictionScore::relative_l1}, {"sum off by", &PredictionScore::sum_ratio}};

const Predictor& bestBaseline(const CrossValidation& result, const LoadClass& loads, double PredictionScore::*value) {
  const Predictor* best = nullptr;
  double least = kAll;
  for (std::size_t p = 1; p < result.predictors.size(); ++p) {
    const double score = medianScore(result.predictors[p], loads.from, loads.to).*value;
    if (!result.predictors[p].is_baseline || !(best == nullptr || score < least)) continue;
    best = &result.predictors[p];
    least = score;
  }
  return *best;
}

std::string percent(double fraction, int digits) {
  return std::isfinite(fraction) ? fmt::format("{:.{}f}", 100 * fraction, digits) : "-";
}

std::string mediansTable(const CrossValidation& result, const LoadClass& loads) {
  std::vector<std::vector<std::string>> rows{{"median" + loads.name, "M1, %", "M4, %", "sum off by, %", "centre, mm", "active off by, %"}};
  for (const Predictor& predictor : result.predictors) {
    const PredictionScore median = medianScore(predictor, loads.from, loads.to);
    rows.push_back({predictor.name, percent(median.median_difference, 2), percent(median.relative_l1, 1), percent(median.sum_ratio, 1),
                    std::isfinite(median.center_distance) ? fmt::format("{:.2f}", 1e3 * median.center_distance) : "-",
                    percent(median.active_ratio, 0)});
  }
  return tableText(rows);
}

// M4 of each measurement.
std::string scoresTable(const CrossValidation& result) {
  std::vector<std::vector<std::string>> rows{{"M4, %", "load, N"}};
  for (const Predictor& predictor : result.predictors) rows[0].push_back(predictor.name);
  rows[0].emplace_back("sum, fitted / real");
  for (std::size_t k = 0; k < result.predictors.front().scores.size(); ++k) {
    const PredictionScore& fitted = result.predictors.front().scores[k];
    std::vector<std::string>& row = rows.emplace_back();
    row = {fitted.measurement, fmt::format("{:.3g}", fitted.load)};
    for (const Predictor& predictor : result.predictors) row.push_back(percent(predictor.scores[k].relative_l1, 1));
    row.push_back(fmt::format("{:.3f}", fitted.sum_ratio));
  }
  return tableText(rows);
}

}  // namespace

std::string verdictText(const CrossValidation& result, double light_below) {
  if (!hasScores(result)) return fmt::format("left-out {}: {}", result.left_out, result.remark);
  std::string worse, better;
  for (const LoadClass& loads : classesOf(result, light_below)) {
    for (const Metric& metric : kJudged) {
      const Predictor& baseline = bestBaseline(result, loads, metric.value);
      const double own = medianScore(result.predictors.front(), loads.from, loads.to).*metric.value;
      const double other = medianScore(baseline, loads.from, loads.to).*metric.value;
      std::string& list = own <= other ? better : worse;
      list += fmt::format("{}{}{} {} % against {} % ({})", list.empty() ? "" : "; ", metric.name, loads.name, percent(own, 1),
                          percent(other, 1), baseline.name);
    }
  }
  if (worse.empty()) return fmt::format("left-out {}: the fitted sensor predicts better than every baseline: {}", result.left_out, better);
  return fmt::format("left-out {}: a baseline predicts better than the fitted sensor: {}", result.left_out, worse);
}

std::string crossValidationText(std::span<const CrossValidation> results, double light_below) {
  std::string text;
  for (const CrossValidation& result : results) {
    text += verdictText(result, light_below) + "\n";
    if (hasScores(result) && !result.remark.empty()) text += fmt::format("left-out {}: {}\n", result.left_out, result.remark);
  }
  for (const CrossValidation& result : results) {
    if (!hasScores(result)) continue;
    std::vector<LoadClass> classes = classesOf(result, light_below);
    if (classes.size() > 1) classes.push_back({.name = " over all loads"});
    for (const LoadClass& loads : classes) text += "\n" + mediansTable(result, loads);
    text += "\n" + scoresTable(result);
    text += fmt::format("\nlongest fit: {:.1f} s of processor time\n", result.longest_fit);
  }
  return text;
}

nlohmann::ordered_json crossValidationJson(std::span<const CrossValidation> results, double light_below) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const CrossValidation& result : results) {
    nlohmann::ordered_json entry{{"left_out", result.left_out},
                                 {"verdict", verdictText(result, light_below)},
                                 {"remark", result.remark},
                                 {"longest_fit", result.longest_fit}};
    const auto scoreJson = [](const PredictionScore& score) {
      return nlohmann::ordered_json{{"M1_median_difference", score.median_difference},
                                    {"M4_relative_l1", score.relative_l1},
                                    {"sum_ratio", score.sum_ratio},
                                    {"center_distance", score.center_distance},
                                    {"active_ratio", score.active_ratio}};
    };
    for (const Predictor& predictor : result.predictors) {
      nlohmann::ordered_json scores = nlohmann::ordered_json::array();
      for (const PredictionScore& score : predictor.scores) {
        nlohmann::ordered_json json{{"measurement", score.measurement}, {"load", score.load}};
        json.update(scoreJson(score));
        scores.push_back(std::move(json));
      }
      entry["predictors"].push_back({{"name", predictor.name}, {"scores", std::move(scores)}});
    }
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace taxelsim::figures
