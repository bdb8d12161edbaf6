#include "figures/characterize_report.h"

#include <openssl/evp.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/files.h"
#include "figures/line_chart.h"
#include "figures/tactile_figure.h"
#include "figures/text.h"
#include "taxelsim/version.h"

namespace taxelsim::figures {
namespace {

constexpr std::uintmax_t kMaxPictureBytes = std::uintmax_t{64} << 20;

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse;margin:1rem 0}td,th{padding:.25rem .75rem;text-align:left;border-bottom:1px solid #ddd;"
    "font-variant-numeric:tabular-nums}img{max-width:100%}.undetermined{color:#888}";

// For text and for values of attributes.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '&') {
      result += "&amp;";
    } else if (c == '"') {
      result += "&quot;";
    } else if (c == '\'') {
      result += "&#39;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // OpenSSL appends a 0
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::filesystem::path pictureName(const std::filesystem::path& report, const std::string& what) {
  std::string name;
  for (const char c : what) {
    const bool kept = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (kept) name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (!kept && !name.empty() && name.back() != '_') name += '_';
  }
  return report.parent_path() / (report.stem().string() + "_" + name + ".png");
}

LinePanel panelOf(const FitFigure& figure) {
  LinePanel panel{.title = figure.title, .x_label = figure.x_label, .y_label = figure.y_label};
  for (const FitFigure::Curve& curve : figure.curves) {
    panel.series.push_back(
        {.name = curve.name, .x = curve.x, .y = curve.y, .style = curve.measured ? LineStyle::kPoints : LineStyle::kLine});
  }
  return panel;
}

// Values of the taxels of a grid.
TactilePanel gridPanel(const GridPatch& patch, std::vector<double> values, std::string title) {
  TactilePanel panel;
  panel.num_rows = patch.num_rows;
  panel.num_cols = patch.num_cols;
  panel.pitch = patch.pitch;
  for (double& value : values) value = std::round(value * 100) / 100;  // more digits do not fit into a cell
  panel.values = std::move(values);
  panel.title = std::move(title);
  panel.neighbours = false;
  return panel;
}

bool isOf(const Estimate& estimate, std::string_view block) {
  return estimate.determined && estimate.parameter.starts_with(block);
}

bool hasAny(const Characterization& result, std::string_view block) {
  return std::any_of(result.estimates.begin(), result.estimates.end(), [&](const Estimate& e) { return isOf(e, block); });
}

std::string pictureHtml(const std::filesystem::path& file) {
  return fmt::format("<p><img alt=\"{}\" src=\"data:image/png;base64,{}\"></p>\n", escaped(file.stem().string()),
                     base64(readTextFile(file, kMaxPictureBytes)));
}

}  // namespace

std::string estimateText(const Estimate& estimate) {
  if (!estimate.determined) return "not determined: " + estimate.remark;
  const std::string unit = estimate.unit.empty() ? "" : " " + estimate.unit;
  if (estimate.low == estimate.high) return roundedText(estimate.value) + unit;
  return fmt::format("{} ({} to {}){}", roundedText(estimate.value), roundedText(estimate.low), roundedText(estimate.high), unit);
}

std::vector<std::filesystem::path> drawCharacterization(const std::filesystem::path& report, const Characterization& result) {
  std::vector<std::filesystem::path> files;
  for (const FitFigure& figure : result.figures) {
    std::filesystem::path file = pictureName(report, figure.title);
    for (int number = 2; std::find(files.begin(), files.end(), file) != files.end(); ++number) {
      file = pictureName(report, fmt::format("{} {}", figure.title, number));
    }
    files.push_back(file);
    writeLineChart(files.back(), {panelOf(figure)}, {.title = result.sensor.name});
  }
  const Sensor& sensor = result.sensor;
  const GridPatch& patch = sensor.patches.front();
  if (hasAny(result, "readout.taxel_gain") && sensor.patches.size() == 1) {
    files.push_back(pictureName(report, "gain_map"));
    writeTactileFigure(files.back(), {gridPanel(patch, sensor.readout.taxel_gain, "Gain of each taxel")},
                       {.title = sensor.name, .subtitle = "", .unit = "gain"});
  }
  if (hasAny(result, "psf.") && sensor.psf.sigma == 0) {
    files.push_back(pictureName(report, "point_spread"));
    GridPatch kernel = patch;
    kernel.num_rows = kernel.num_cols = sensor.psf.size;
    const double sum = std::accumulate(sensor.psf.kernel.begin(), sensor.psf.kernel.end(), 0.0);
    std::vector<double> shares;
    for (const double weight : sensor.psf.kernel) shares.push_back(weight / sum);
    writeTactileFigure(files.back(), {gridPanel(kernel, std::move(shares), "Point spread function")},
                       {.title = sensor.name, .subtitle = "", .unit = "share"});
  }
  return files;
}

void writeReport(const std::filesystem::path& report, std::span<const Measurement> measurements, const Characterization& result,
                 const std::string& scores, const std::vector<std::filesystem::path>& figures) {
  const std::string title = "Characterisation of " + escaped(result.sensor.name);
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{}</title><style>{}</style>\n<h1>{}</h1>\n", title, kStyle, title);
  if (!scores.empty()) page += "<pre>" + escaped(scores) + "</pre>\n";
  page += fmt::format("<p>Fitted by taxelsim {} to these measurements:</p>\n<ul>\n", kVersion);
  for (const Measurement& measurement : measurements) page += "<li>" + escaped(measurement.file.filename().string()) + "</li>\n";
  page += "</ul>\n<h2>Parameters</h2>\n<table><tr><th>parameter</th><th>value (95 % interval)</th><th>remark</th></tr>\n";
  for (const Estimate& estimate : result.estimates) {
    page += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td></tr>\n", estimate.determined ? "" : " class=\"undetermined\"",
                        escaped(estimate.parameter), escaped(estimateText(estimate)), estimate.determined ? escaped(estimate.remark) : "");
  }
  page += "</table>\n<h2>Residuals</h2>\n<table><tr><th>measurement</th><th>rms</th><th>rows</th><th>outliers</th></tr>\n";
  for (const FitQuality& fit : result.fits) {
    page += fmt::format("<tr><td>{}</td><td>{} {}</td><td>{}</td><td>{}</td></tr>\n", escaped(fit.measurement), roundedText(fit.rms),
                        escaped(fit.unit), fit.num_rows, fit.num_outliers);
  }
  page += "</table>\n";
  if (!result.dead_taxels.empty()) page += fmt::format("<p>Taxels without a response: {}</p>\n", fmt::join(result.dead_taxels, ", "));
  for (const std::string& remark : result.remarks) page += "<p>" + escaped(remark) + "</p>\n";
  for (const std::filesystem::path& figure : figures) page += pictureHtml(figure);
  page += "</html>\n";
  writeFileAtomically(report, std::as_bytes(std::span(page)));
}

}  // namespace taxelsim::figures
