// The image that a recording under a stamp stands for.
#pragma once

#include "characterize/stamp_model.h"

namespace taxelsim {

// Sum of counts, and the median of each taxel over the frames from 4.5 to 5.5 s after contact. Throws Error(kInput), one line that begins
// with the file, if there is no contact or no such frame.
Stamp stampOf(const Measurement& measurement);

}  // namespace taxelsim
