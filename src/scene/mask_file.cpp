#include "scene/mask_file.h"

#include <algorithm>

#include "scene/csv_reader.h"

namespace taxelsim {

FootprintMask readMask(const std::filesystem::path& file, double pixel) {
  constexpr double kMostPressure = 1e12;
  CsvReader reader(file);
  FootprintMask mask{.pixel = pixel, .pressure = {}};
  for (; reader.next(); ++mask.num_rows) {
    const std::size_t count = reader.fields().size();
    if (mask.num_rows == 0) mask.num_cols = count;
    if (count != mask.num_cols) {
      reader.fail(1, std::to_string(count) + " pixels are not allowed: the first row has " + std::to_string(mask.num_cols));
    }
    if (mask.pressure.size() + count > kMaxMaskPixels) {
      reader.fail(1, "more than " + std::to_string(kMaxMaskPixels) + " pixels: use larger ones");
    }
    for (std::size_t c = 0; c < count; ++c) mask.pressure.push_back(static_cast<float>(reader.number(c, {"pixel", 0, kMostPressure})));
  }
  if (std::none_of(mask.pressure.begin(), mask.pressure.end(), [](float pressure) { return pressure > 0; })) {
    failAt(reader.file(), "no pixel above 0");
  }
  return mask;
}

}  // namespace taxelsim
