#include "characterize/stamp_recording.h"

#include <algorithm>
#include <utility>

#include "base/median.h"
#include "base/text.h"
#include "characterize/creep.h"
#include "characterize/limits.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kWindowBegin = 4.5, kWindowEnd = 5.5;  // s after contact

CreepSeries sumOf(const Measurement& measurement, const Images& images) {
  CreepSeries sum{.file = measurement.file.generic_string(), .time = images.time, .values = {}};
  for (std::size_t row = 0; row < images.time.size(); ++row) {
    double total = 0;
    for (std::size_t t = 0; t < images.num_taxels; ++t) total += images.counts[row * images.num_taxels + t];
    sum.values.push_back(total);
  }
  return sum;
}

}  // namespace

Stamp stampOf(const Measurement& measurement) {
  Stamp stamp{.measurement = &measurement, .data = &std::get<StampImages>(measurement.data), .sum = {}, .image = {}, .taxels = {}};
  const Images& images = stamp.data->images;
  stamp.sum = sumOf(measurement, images);
  if (*std::max_element(stamp.sum.values.begin(), stamp.sum.values.end()) <= kStill) {
    throw Error(ErrorKind::kInput, stamp.sum.file + ": no contact: the sum of all counts never exceeds 2");
  }
  const Onset onset = onsetOf(stamp.sum);
  for (std::size_t t = 0; t < images.num_taxels; ++t) {
    std::vector<double> counts;
    for (std::size_t row = onset.first_row; row < onset.end_row; ++row) {
      const double after = images.time[row] - onset.start;
      if (after >= kWindowBegin && after <= kWindowEnd) counts.push_back(images.counts[row * images.num_taxels + t]);
    }
    if (counts.empty()) {
      throw Error(ErrorKind::kInput, stamp.sum.file + ": no frame under load from " + numberText(kWindowBegin) + " to " +
                                         numberText(kWindowEnd) + " s after contact");
    }
    stamp.image.push_back(medianOf(std::move(counts)));
  }
  return stamp;
}

}  // namespace taxelsim
