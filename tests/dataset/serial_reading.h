// Reads many files that may crash or hang HDF5, without a process for each.
#pragma once

#include "support/test.h"

namespace taxelsim::testing {

enum class Outcome : unsigned char { kEnded, kRefused, kRead };  // kEnded: the child that read it

// Calls read(i) for each i below `count` in a child process, which begins anew after a crash and after 500 files. A file has the limits of
// dataset::ChildLimits: 5 s of the processor, and 512 MiB for all files of a child. Throws std::runtime_error if a child uses no processor
// time for 5 minutes.
std::vector<Outcome> readSerially(std::size_t count, const std::function<void(std::size_t)>& read);

}  // namespace taxelsim::testing
