#include "peers/bar_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "figures/canvas.h"
#include "figures/line_chart.h"

namespace taxelsim::bench {
namespace {

constexpr std::size_t kColours = 7;  // of seriesColour(); further series repeat them paler
constexpr double kPale = 0.45;
// Sizes in points.
constexpr double kLabels = 190, kAxis = 560, kNumbers = 70, kBar = 11, kGap = 12, kLegendRow = 16;

std::string shortNumber(double value) {
  char text[32];
  if (value >= 1e6) {
    std::snprintf(text, sizeof text, "%.2f M", value / 1e6);
  } else if (value >= 1e3) {
    std::snprintf(text, sizeof text, value >= 1e5 ? "%.0f k" : "%.1f k", value / 1e3);
  } else {
    std::snprintf(text, sizeof text, "%.0f", value);
  }
  return text;
}

void useColour(const figures::Canvas& canvas, std::size_t entry) {
  canvas.colour(figures::seriesColour(entry), entry < kColours ? 1 : kPale);
}

// All timed peers, in order of first appearance.
std::vector<PeerResult> legendOf(const std::vector<CaseResult>& results) {
  std::vector<PeerResult> legend;
  for (const CaseResult& result : results) {
    for (const PeerResult& peer : result.peers) {
      const bool known = std::any_of(legend.begin(), legend.end(), [&](const PeerResult& other) { return other.name == peer.name; });
      if (!known && !peer.seconds.empty()) legend.push_back(peer);
    }
  }
  return legend;
}

}  // namespace

void writeBarChart(const std::filesystem::path& file, const std::string& subtitle, const std::vector<CaseResult>& results) {
  const std::vector<PeerResult> legend = legendOf(results);
  double low = 1e30, high = 0, bars = 0;
  for (const CaseResult& result : results) {
    for (const PeerResult& peer : result.peers) {
      if (peer.seconds.empty()) continue;
      low = std::min(low, peer.framesPerSecond());
      high = std::max(high, peer.framesPerSecond());
      ++bars;
    }
  }
  if (bars == 0) return;
  const double first = std::floor(std::log10(low)), last = std::max(first + 1, std::ceil(std::log10(high)));
  const double top = figures::headingRoom(subtitle) + kLegendRow * static_cast<double>(legend.size()) + 16;
  const double bottom = top + bars * kBar + static_cast<double>(results.size()) * kGap;
  const double left = figures::kMargin + kLabels, width = left + kAxis + kNumbers + figures::kMargin;
  const auto x = [&](double value) { return left + kAxis * (std::log10(value) - first) / (last - first); };

  const figures::Canvas canvas(width, bottom + 40);
  canvas.heading("Frames per second, poses to features", subtitle, width);
  canvas.font(figures::kSmall);
  double y = figures::headingRoom(subtitle);
  for (std::size_t k = 0; k < legend.size(); ++k, y += kLegendRow) {
    useColour(canvas, k);
    cairo_rectangle(canvas, left, y, 10, 10);
    cairo_fill(canvas);
    canvas.colour(figures::kInk);
    canvas.text(left + 16, y + 9, legend[k].name + ": " + legend[k].what, 0, kAxis);
  }
  for (double power = first; power <= last; ++power) {
    const double at = x(std::pow(10, power));
    canvas.colour(figures::kGap);
    cairo_rectangle(canvas, at, top - 4, 0.8, bottom - top + 4);
    cairo_fill(canvas);
    canvas.colour(figures::kGrey);
    canvas.text(at, bottom + 14, shortNumber(std::pow(10, power)), 0.5);
  }
  canvas.text(left + kAxis / 2, bottom + 30, "frames per second, logarithmic", 0.5);

  y = top;
  for (const CaseResult& result : results) {
    const double begin = y;
    for (const PeerResult& peer : result.peers) {
      if (peer.seconds.empty()) continue;
      const auto entry = std::find_if(legend.begin(), legend.end(), [&](const PeerResult& other) { return other.name == peer.name; });
      useColour(canvas, static_cast<std::size_t>(entry - legend.begin()));
      const double end = x(peer.framesPerSecond());
      cairo_rectangle(canvas, left, y + 1, std::max(1.0, end - left), kBar - 2);
      cairo_fill(canvas);
      canvas.colour(figures::kInk);
      canvas.text(end + 4, y + kBar - 2, shortNumber(peer.framesPerSecond()));
      y += kBar;
    }
    canvas.colour(figures::kInk);
    canvas.text(left - 8, (begin + y) / 2 + 1, result.name, 1, kLabels);
    canvas.colour(figures::kGrey);
    canvas.text(left - 8, (begin + y) / 2 + 13, result.array + ", " + std::to_string(result.num_instances) + " instances", 1, kLabels);
    y += kGap;
  }
  canvas.save(file);
}

}  // namespace taxelsim::bench
