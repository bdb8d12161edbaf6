#include "verdict_arrays.h"

#include <nanobind/ndarray.h>

#include <algorithm>

namespace taxelsim::python {
namespace {

// One member of all verdicts as an array of its own: (num_episodes), or (num_episodes, width) for arrays.
template <typename Element, typename Member>
nb::object column(const std::vector<Verdict>& verdicts, Member Verdict::*member, std::size_t width) {
  const std::size_t size = verdicts.size() * width;
  auto* const values = new Element[size];
  const nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<Element*>(p); });
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const auto* const first = reinterpret_cast<const Element*>(&(verdicts[i].*member));
    std::copy(first, first + width, values + i * width);
  }
  const std::size_t shape[2] = {verdicts.size(), width};
  return nb::ndarray<nb::numpy, Element>(values, width == 1 ? 1 : 2, shape, owner).cast();
}

}  // namespace

nb::dict arraysOf(const std::vector<Verdict>& verdicts) {
  nb::dict arrays;
  arrays["episode"] = column<std::uint64_t>(verdicts, &Verdict::episode, 1);
  arrays["object"] = column<int>(verdicts, &Verdict::object, 1);
  arrays["success"] = column<bool>(verdicts, &Verdict::success, 1);
  arrays["start_error"] = column<float>(verdicts, &Verdict::start_error, kNumTaskMeasures);
  arrays["steady_error"] = column<float>(verdicts, &Verdict::steady_error, kNumTaskMeasures);
  arrays["settling_time"] = column<float>(verdicts, &Verdict::settling_time, 1);
  arrays["travel"] = column<float>(verdicts, &Verdict::travel, 1);
  arrays["laps"] = column<float>(verdicts, &Verdict::laps, 1);
  arrays["peak_force"] = column<float>(verdicts, &Verdict::peak_force, 1);
  arrays["saturated"] = column<float>(verdicts, &Verdict::saturated, 1);
  arrays["num_losses"] = column<int>(verdicts, &Verdict::num_losses, 1);
  arrays["robot"] = column<std::uint8_t>(verdicts, &Verdict::robot, 1);
  arrays["load_reached"] = column<bool>(verdicts, &Verdict::load_reached, 1);
  return arrays;
}

}  // namespace taxelsim::python
