// Contact points from a text file.
#pragma once

#include <filesystem>
#include <vector>

#include "taxelsim/contact_point.h"

namespace taxelsim::cli {

// Reads one contact per line: x, y, z (m, in S) and normal force (N), separated by commas; `#` begins a comment. Throws Error(kInput) with
// file, line and column for a value that is not allowed, and for more than kMaxContacts contacts.
std::vector<ContactPoint> readContacts(const std::filesystem::path& file);

}  // namespace taxelsim::cli
