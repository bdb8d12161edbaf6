#include "characterize/point_images.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "characterize/footprint.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kStill = 2;             // counts: an image with no more has no contact
constexpr std::size_t kMaxImages = 600;  // more are subsampled evenly
constexpr double kLeastOnArray = 1e-3;   // of an indenter's force

// Share of the indenter's force on each taxel; `place` in m, in P.
std::vector<double> sharesOf(const GridPatch& patch, const Indenter& indenter, const std::array<double, 2>& place,
                             const std::vector<PressedSection>& sections) {
  std::vector<double> shares(static_cast<std::size_t>(patch.num_rows * patch.num_cols));
  double total = 0;
  for (const PressedSection& section : sections) {
    const Polygon polygon = moved(sectionOf(indenter, section.height), place);
    const double per_area = section.volume / indenter.sectionAt(section.height);
    total += section.volume;
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double x = (i - patch.num_rows / 2.0) * patch.pitch[0], y = (j - patch.num_cols / 2.0) * patch.pitch[1];
        shares[static_cast<std::size_t>(i * patch.num_cols + j)] +=
            per_area * overlap(polygon, {x, y}, {x + patch.pitch[0], y + patch.pitch[1]});
      }
    }
  }
  for (double& share : shares) share /= total;
  return shares;
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
    image.amplitude += nominalForce(sensor.readout, counts);
  }
  if (most <= kStill) return Contact::kNone;
  if (!points.force.empty()) image.force = std::max(0.0, points.force[row]);
  const double force = image.force > 0 ? image.force : image.amplitude;
  const double depth = depthOfVolume(points.indenter, foundation.normal_exponent, force / foundation.normal_contact_stiffness);
  image.share = sharesOf(sensor.patches[0], points.indenter, points.position[row],
                         pressedSections(points.indenter, foundation.normal_exponent, depth));
  const double on_array = sumOf(image.share);
  if (on_array < kLeastOnArray) return Contact::kOffArray;
  image.amplitude = std::max(image.amplitude, 1e-6) / on_array;
  for (std::size_t t = 0; t < image.share.size(); ++t) {
    if (image.share[t] > 0) image.loaded.push_back(t);
  }
  return Contact::kOnArray;
}

}  // namespace

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
