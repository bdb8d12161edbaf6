#include "characterize/stamp_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "characterize/validation_parts.h"

namespace taxelsim {
namespace {

// Fraction of the pitch; an offset of it moves 6 % of the counts of a stamp that is three taxels wide.
constexpr double kSamePlace = 0.1;

struct Place {
  std::string fixture;
  std::array<double, 2> position{std::nan(""), std::nan("")};  // m; equals no other place where it was not fitted
};

Place placeOf(const Measurement& stamp, const Characterization& fit) {
  Place place{.fixture = std::get<StampImages>(stamp.data).fixture};
  for (const Estimate& estimate : fit.estimates) {
    if (estimate.parameter == stamp.name + ".x") place.position[0] = estimate.value;
    if (estimate.parameter == stamp.name + ".y") place.position[1] = estimate.value;
  }
  return place;
}

}  // namespace

std::vector<std::size_t> placesOf(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others, double& longest) {
  Characterization fit;
  const auto has_fixture = [](const Measurement& stamp) { return !std::get<StampImages>(stamp.data).fixture.empty(); };
  if (!std::all_of(stamps.begin(), stamps.end(), has_fixture)) {
    std::vector<Measurement> all = stamps;
    all.insert(all.end(), others.begin(), others.end());
    fit = timedFit(all, longest);
  }
  std::vector<Place> places;  // the first press at each
  std::vector<std::size_t> numbers;
  for (const Measurement& stamp : stamps) {
    const Place own = placeOf(stamp, fit);
    const double least = kSamePlace * std::min(stamp.sensor.patches[0].pitch[0], stamp.sensor.patches[0].pitch[1]);
    const auto known = std::find_if(places.begin(), places.end(), [&](const Place& place) {
      const double distance = std::hypot(own.position[0] - place.position[0], own.position[1] - place.position[1]);
      return own.fixture == place.fixture && (!own.fixture.empty() || distance < least);
    });
    numbers.push_back(static_cast<std::size_t>(known - places.begin()));
    if (known == places.end()) places.push_back(own);
  }
  return numbers;
}

}  // namespace taxelsim
