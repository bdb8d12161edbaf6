// A policy of Python as an argument of a run.
#pragma once

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <optional>
#include <string>
#include <tuple>

#include "bind.h"
#include "calling_thread.h"
#include "taxelsim/policy.h"
#include "taxelsim/scene.h"

namespace taxelsim::python {

// A policy of Python: its name, its identity, whether it commands joint velocities, the outputs that it observes, and a callable (arrays,
// instances, first_instance) -> twists (num_due, 6) or joint velocities (num_due, num_joints). The arrays are valid during the call. The
// callable runs in the calling thread.
using PolicyArgument = std::optional<std::tuple<std::string, std::string, bool, OutputOptions, nb::callable>>;

// All references must outlive the policy.
std::optional<Policy> policyOf(const PolicyArgument& argument, const Scene& scene, CallingThread& calling_thread);

}  // namespace taxelsim::python
