#include "sweep/descent.h"

#include <cmath>
#include <map>

namespace taxelsim::bench {

double secondsOf(const FrameTime& time, Pass pass) {
  const double seconds = pass == Pass::kContact ? time.contact : time.image;
  return std::isnan(seconds) ? time.wall : seconds;
}

Setting descend(const Setting& start, const FrameTime& start_time, const Descent& how, const Measure& measure) {
  std::map<Setting, std::optional<FrameTime>> known{{start, start_time}};
  const auto timeOf = [&](const Setting& setting) {
    const auto found = known.find(setting);
    return found != known.end() ? found->second : known.emplace(setting, measure(setting)).first->second;
  };
  Setting best = start;
  for (int round = 0; round < how.rounds; ++round) {
    const Setting before = best;
    for (const std::size_t axis : how.over) {
      const Pass pass = axes()[axis].pass;
      const std::vector<int>& values = how.only.empty() ? axes()[axis].values : how.only[axis];
      const Setting from = best;
      for (const int value : values) {
        const Setting candidate = moved(from, axis, value);
        if (axis == kImageTeam && candidate[axis] != value) continue;  // a team larger than its workgroup
        const std::optional<FrameTime> time = timeOf(candidate);
        if (time && secondsOf(*time, pass) < (1 - how.least_gain) * secondsOf(*timeOf(best), pass)) best = candidate;
      }
    }
    if (best == before) break;
  }
  return best;
}

}  // namespace taxelsim::bench
