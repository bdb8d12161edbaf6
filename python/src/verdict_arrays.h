// Verdicts in Python.
#pragma once

#include <vector>

#include "bind.h"
#include "taxelsim/verdict.h"

namespace taxelsim::python {

// Members of the verdicts as arrays (num_verdicts, ...) of their own, by name.
nb::dict arraysOf(const std::vector<Verdict>& verdicts);

}  // namespace taxelsim::python
