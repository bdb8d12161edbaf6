#include "scene/curve_reader.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sensor/fields.h"

namespace taxelsim {
namespace {

// Force and counts ascend strictly from point to point, from 0.
std::vector<CurvePoint> readCurvePoints(const YamlNode& node, Canonical& canonical) {
  const std::string what = "a list of 1 to " + std::to_string(kMaxCurvePoints) + " points, [N, counts] each";
  const std::vector<YamlNode> items = node.items(what);
  if (items.empty() || items.size() > static_cast<std::size_t>(kMaxCurvePoints)) node.refuse(what);
  std::vector<CurvePoint> points;
  CurvePoint before;
  std::string text;
  for (const YamlNode& item : items) {
    const std::vector<YamlNode> pair = item.items("a point, [N, counts]");
    if (pair.size() != 2) item.refuse("a point, [N, counts]");
    const CurvePoint& point = points.emplace_back(
        CurvePoint{pair[0].number(Allowed::above(before.force, "N")), pair[1].number(Allowed::above(before.counts, "counts"))});
    text += (text.empty() ? "" : ", ") + canonicalList(std::array{point.force, point.counts});
    before = point;
  }
  canonical.line("points", "[" + text + "]");
  return points;
}

}  // namespace

void readCurve(const YamlMap& from, Readout& readout) {
  from.require("curve", "{counts_per_newton: ...}, {coefficients: [...]} or {points: [...]}");
  const YamlMap map(from, "curve");
  if (const std::optional<YamlNode> points = map.find("points")) {
    for (const char* const key : {"counts_per_newton", "coefficients", "limit"}) map.rejectBoth(key, "points");
    readout.curve_points = readCurvePoints(*points, map.canonical());
    return;
  }
  std::vector<double>& curve = readout.curve;
  curve.clear();
  if (const std::optional<YamlNode> slope = map.find("counts_per_newton")) {
    map.rejectBoth("coefficients", "counts_per_newton");
    curve = {slope->number(map.allowedOf("counts_per_newton"))};
  } else {
    const YamlNode coefficients = map.require("coefficients", "a list of 1 to 5 numbers, counts/N^m; or counts_per_newton");
    const std::vector<YamlNode> items = coefficients.items("a list of 1 to 5 numbers");
    if (items.empty() || items.size() > static_cast<std::size_t>(kMaxCurveDegree)) coefficients.refuse("a list of 1 to 5 numbers");
    for (const YamlNode& item : items) curve.push_back(item.number(map.allowedOf("coefficients")));
  }
  map.canonical().line("coefficients", canonicalList(curve));
  readFields(map, kCurveLimitFields, readout);
}

}  // namespace taxelsim
