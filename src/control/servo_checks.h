// Validation of tactile servo settings.
#pragma once

#include "taxelsim/control.h"

namespace taxelsim {

// Throws Error(kInput) for a gain, reference or limit out of range, for conflicting features, and if no feature is selected.
void checkServo(const TactileServo& servo);

}  // namespace taxelsim
