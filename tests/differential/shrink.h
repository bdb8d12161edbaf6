// Shrinks a contact on which two implementations differ to a small one on which they still do.
#pragma once

#include "differential/random_contacts.h"
#include "support/test.h"

namespace taxelsim::support {

// A set with one contact. `differs` says whether the implementations differ on it; it is called at most `max_calls` times.
//
// Until nothing helps any more: removes objects, halves meshes and the grid, takes one sample a taxel, removes patches and the point
// spread, sets rotations to the identity, and rounds positions to few digits.
ContactSet shrink(ContactSet set, const std::function<bool(const ContactSet&)>& differs, int max_calls = 200);

// Sensor file, objects and poses as text: what is needed to see the difference again.
std::string sceneText(const ContactSet& set);

}  // namespace taxelsim::support
