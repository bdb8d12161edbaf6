// Device and Model as Python holds them.
#pragma once

#include "owned.h"
#include "taxelsim/device.h"
#include "taxelsim/model.h"

namespace taxelsim::python {

using DeviceHandle = Owned<Device>;
using ModelHandle = Owned<Model>;

}  // namespace taxelsim::python
