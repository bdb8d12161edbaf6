// Counts the episodes of a run that touch nothing (taxelsim/contact_misses.h), and warns of them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "episodes/clearance.h"
#include "episodes/plan.h"
#include "taxelsim/contact_misses.h"

namespace taxelsim {

// For slices. Measures distances in episodes that missed, at their start, so that other episodes cost nothing. Not thread-safe.
class ContactMissCounter {
 public:
  // Both must outlive this.
  ContactMissCounter(const EpisodePlan& plan, ContactMisses& misses)
      : plan_(plan), misses_(misses), clearance_(plan.scene.sensor, plan.scene.objects) {}

  // Counts an episode. touched: whether it had contact in any frame, or a load out of reach. Recorded episodes without points do not miss.
  void add(std::uint64_t episode, bool touched);

 private:
  double nearestStart(std::uint64_t episode) const;

  const EpisodePlan& plan_;
  ContactMisses& misses_;
  Clearance clearance_;
};

void add(ContactMisses& sum, const ContactMisses& more);

// Logs one line about a run of the scene if there are any. `all`: of the fingers in a scene of kind grasp, else of the controllers that
// `names` has, or of the whole run.
void warnOfContactMisses(const Scene& scene, std::span<const ContactMisses> all, std::span<const std::string> names = {});

}  // namespace taxelsim
