// Contact points from a text file.
#pragma once

#include <filesystem>
#include <vector>

#include "taxelsim/contact_point.h"

namespace taxelsim::cli {

// A line a contact: x, y, z in m in S and the normal force in N, with commas between; blank lines and what follows a '#' do not count.
// Throws Error(kInput) with file, line and value for anything else, and for more contacts than one sensor takes.
std::vector<ContactPoint> readContacts(const std::filesystem::path& file);

}  // namespace taxelsim::cli
