#include "characterize/point_images.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "characterize/limits.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxImages = 600;  // more are subsampled evenly
constexpr double kLeastOnArray = 1e-3;   // of an indenter's force

// Adds the share of the indenter's force on each taxel; `place` in m, in P.
void addShares(const GridPatch& patch, const Indenter& indenter, const std::array<double, 2>& place, double yaw,
               const std::vector<PressedSection>& sections, std::vector<double>& shares) {
  double total = 0;
  for (const PressedSection& section : sections) total += section.volume;
  for (const PressedSection& section : sections) {
    const Polygon polygon = moved(sectionOf(indenter, section.height), place, yaw);
    const double per_area = section.volume / (indenter.sectionAt(section.height) * total);
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double x = (i - patch.num_rows / 2.0) * patch.pitch[0], y = (j - patch.num_cols / 2.0) * patch.pitch[1];
        shares[static_cast<std::size_t>(i * patch.num_cols + j)] +=
            per_area * overlap(polygon, {x, y}, {x + patch.pitch[0], y + patch.pitch[1]});
      }
    }
  }
}

// The same of a mask. A pixel that is turned counts as the square with sides along x and y around its middle.
void addShares(const GridPatch& patch, const FootprintMask& mask, const std::array<double, 2>& place, double yaw,
               std::vector<double>& shares) {
  const double c = std::cos(yaw), s = std::sin(yaw), half = mask.pixel / 2;
  double total = 0;
  for (const float pressure : mask.pressure) total += pressure;
  // Part of [middle - half, middle + half] in cell k of `count` cells around 0.
  const auto part = [&](double middle, int k, int count, double pitch) {
    const double low = (k - count / 2.0) * pitch;
    return std::max(0.0, std::min(middle + half, low + pitch) - std::max(middle - half, low)) / mask.pixel;
  };
  const auto firstCell = [&](double middle, int count, double pitch) {
    return std::max(0, static_cast<int>(std::floor(std::max(-1.0, (middle - half) / pitch + count / 2.0))));
  };
  for (std::size_t p = 0; p < mask.pressure.size(); ++p) {
    if (!(mask.pressure[p] > 0)) continue;
    const std::size_t row = p / mask.num_cols, col = p % mask.num_cols;
    const double u = (static_cast<double>(row) - (static_cast<double>(mask.num_rows) - 1) / 2) * mask.pixel;
    const double v = (static_cast<double>(col) - (static_cast<double>(mask.num_cols) - 1) / 2) * mask.pixel;
    const double x = place[0] + c * u - s * v, y = place[1] + s * u + c * v;
    for (int i = firstCell(x, patch.num_rows, patch.pitch[0]); i < patch.num_rows; ++i) {
      const double along_x = part(x, i, patch.num_rows, patch.pitch[0]);
      if (along_x <= 0) break;
      for (int j = firstCell(y, patch.num_cols, patch.pitch[1]); j < patch.num_cols; ++j) {
        const double along_y = part(y, j, patch.num_cols, patch.pitch[1]);
        if (along_y <= 0) break;
        shares[static_cast<std::size_t>(i * patch.num_cols + j)] += mask.pressure[p] / total * along_x * along_y;
      }
    }
  }
}

double sumOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

enum class Contact { kNone, kOffArray, kOnArray };

// Fills `image` from one row.
Contact readRow(const PointImages& points, std::size_t row, const Sensor& sensor, const Winkler& foundation, PointImage& image) {
  image.counts = &points.images.counts[row * points.images.num_taxels];
  double most = 0;
  for (std::size_t t = 0; t < points.images.num_taxels; ++t) {
    const double counts = image.counts[t];
    most = std::max(most, counts);
    image.amplitude += std::max(0.0, nominalForce(sensor.readout, counts));
  }
  if (most <= kStill) return Contact::kNone;
  if (!points.force.empty()) image.force = std::max(0.0, points.force[row]);
  if (!points.mask) {
    const double force = image.force > 0 ? image.force : image.amplitude;
    const double depth = depthOfVolume(points.indenter, foundation.normal_exponent, force / foundation.normal_contact_stiffness);
    image.sections = pressedSections(points.indenter, foundation.normal_exponent, depth);
  }
  image.points = &points;
  image.row = row;
  image.place(sensor.patches[0], {0, 0});
  const double on_array = sumOf(image.share);
  if (on_array < kLeastOnArray) return Contact::kOffArray;
  image.amplitude = std::max(image.amplitude, 1e-6) / on_array;
  return Contact::kOnArray;
}

}  // namespace

void PointImage::place(const GridPatch& patch, const std::array<double, 2>& offset) {
  const std::array<double, 2> at{points->position[row][0] + offset[0], points->position[row][1] + offset[1]};
  const double yaw = points->yaw.empty() ? 0 : points->yaw[row];
  share.assign(static_cast<std::size_t>(patch.num_rows * patch.num_cols), 0);
  points->mask ? addShares(patch, *points->mask, at, yaw, share) : addShares(patch, points->indenter, at, yaw, sections, share);
  loaded.clear();
  for (std::size_t t = 0; t < share.size(); ++t) {
    if (share[t] > 0) loaded.push_back(t);
  }
}

std::vector<PointImage> pointImages(Measured measurements, const Sensor& sensor, std::size_t& num_off) {
  std::vector<PointImage> images;
  bool any = false;
  const Winkler foundation = foundationOf(sensor.skin);
  for (const Measurement* measurement : measurements) {
    const auto& points = std::get<PointImages>(measurement->data);
    for (std::size_t row = 0; row < points.position.size(); ++row) {
      PointImage image;
      const Contact contact = readRow(points, row, sensor, foundation, image);
      any = any || contact != Contact::kNone;
      num_off += contact == Contact::kOffArray ? 1 : 0;
      if (contact == Contact::kOnArray) images.push_back(std::move(image));
    }
  }
  const std::string file = measurements.front()->file.generic_string();
  if (!any) throw Error(ErrorKind::kInput, file + ": no contact: no taxel reads more than " + numberText(kStill) + " counts");
  if (images.empty())
    throw Error(ErrorKind::kInput, file + ": the indenter is off the array in all images; x and y are in the frame of its patch");
  if (images.size() > kMaxImages) {
    std::vector<PointImage> kept;
    for (std::size_t k = 0; k < kMaxImages; ++k) kept.push_back(std::move(images[k * images.size() / kMaxImages]));
    images = std::move(kept);
  }
  return images;
}

}  // namespace taxelsim
