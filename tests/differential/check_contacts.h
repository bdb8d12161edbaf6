// Compares frames of this driver with the twin.
#pragma once

#include "differential/random_contacts.h"
#include "support/test.h"

namespace taxelsim::support {

struct ContactResult {
  std::string problem;                // first difference from the twin; empty if there is none
  std::vector<std::uint32_t> values;  // bits of all outputs
  double total_force = 0;             // N
  double looseness = 0;               // of the bounds of springs: see comparison.h
};

// Simulates all contacts of a set as one batch. One result for each contact.
std::vector<ContactResult> checkContacts(const ContactSet& set);

}  // namespace taxelsim::support
