#include "environment_views.h"

#include <nanobind/ndarray.h>

#include <initializer_list>
#include <type_traits>
#include <vector>

#include "frame_views.h"

namespace taxelsim::python {
namespace {

static_assert(sizeof(Pose) == 7 * sizeof(double));

// Elements as Python sees them: flags are booleans, poses seven numbers.
template <typename Element, typename Source>
nb::object arrayOf(std::span<const Source> values, std::initializer_list<std::size_t> shape, nb::handle owner) {
  return nb::ndarray<nb::numpy, const Element>(reinterpret_cast<const Element*>(values.data()), shape.size(), shape.begin(), owner).cast();
}

}  // namespace

nb::dict arraysOf(const EnvironmentView& view, const Sensor& sensor, int num_sensors, nb::handle owner) {
  const std::size_t n = view.active.size(), s = static_cast<std::size_t>(num_sensors), joints = view.joint_positions.size() / n;
  nb::dict arrays;
  arrays["frame"] = arraysOf(view.frame, sensor, static_cast<int>(n * s), {owner});
  arrays["active"] = arrayOf<bool>(view.active, {n}, owner);
  arrays["control_due"] = arrayOf<bool>(view.control_due, {n}, owner);
  arrays["episodes"] = arrayOf<std::uint64_t>(view.episodes, {n}, owner);
  arrays["frame_numbers"] = arrayOf<int>(view.frame_numbers, {n}, owner);
  arrays["times"] = arrayOf<double>(view.times, {n}, owner);
  arrays["objects"] = arrayOf<int>(view.objects, {n}, owner);
  arrays["load_reached"] = arrayOf<bool>(view.load_reached, {n}, owner);
  arrays["start_force"] = arrayOf<float>(view.start_force, {n}, owner);
  arrays["X_SO"] = arrayOf<double>(view.X_SO, {n, s, 7}, owner);
  arrays["X_WO"] = arrayOf<double>(view.X_WO, {n, 7}, owner);
  arrays["X_WS"] = arrayOf<double>(view.X_WS, {n, s, 7}, owner);
  arrays["joint_positions"] = arrayOf<double>(view.joint_positions, {n, joints}, owner);
  arrays["joint_velocities"] = arrayOf<double>(view.joint_velocities, {n, joints}, owner);
  arrays["robot_status"] = arrayOf<std::uint8_t>(view.robot_status, {n}, owner);
  return arrays;
}

nb::dict arraysOf(const GraspView& view, nb::handle owner) {
  const std::size_t n = view.frame_numbers.size(), joints = view.joint_positions.size() / n;
  nb::dict arrays, sensors;
  for (const GraspSensorView& sensor : view.sensors) {
    nb::dict entry;
    entry["frame"] = arraysOf(*sensor.frame, sensor.sensor->sensor, static_cast<int>(sensor.num_rows), {owner});
    entry["first_row"] = sensor.first_row;
    sensors[sensor.sensor->name.c_str()] = std::move(entry);
  }
  arrays["sensors"] = std::move(sensors);
  arrays["dt"] = view.dt;
  arrays["episodes"] = arrayOf<std::uint64_t>(view.episodes, {n}, owner);
  arrays["frame_numbers"] = arrayOf<int>(view.frame_numbers, {n}, owner);
  arrays["X_WO"] = arrayOf<double>(view.X_WO, {n, view.X_WO.size() / n, 7}, owner);
  arrays["X_WS"] = arrayOf<double>(view.X_WS, {n, view.X_WS.size() / n, 7}, owner);
  arrays["joint_positions"] = arrayOf<double>(view.joint_positions, {n, joints}, owner);
  arrays["joint_velocities"] = arrayOf<double>(view.joint_velocities, {n, joints}, owner);
  arrays["robot_status"] = arrayOf<std::uint8_t>(view.robot_status, {n}, owner);
  arrays["target_forces"] = arrayOf<double>(view.target_forces, {n, view.target_forces.size() / n}, owner);
  return arrays;
}

nb::dict arraysOf(const GraspState& state, int num_instances, nb::handle owner) {
  const auto n = static_cast<std::size_t>(num_instances);
  const std::size_t fingers = state.forces.size() / n;
  nb::dict arrays;
  arrays["forces"] = arrayOf<double>(state.forces, {n, fingers}, owner);
  arrays["peak_forces"] = arrayOf<double>(state.peak_forces, {n, fingers}, owner);
  arrays["num_losses"] = arrayOf<int>(state.num_losses, {n, fingers}, owner);
  arrays["were_in_contact"] = arrayOf<bool>(state.were_in_contact, {n, fingers}, owner);
  return arrays;
}

nb::dict arraysOf(const TaskState& state, nb::handle owner) {
  const std::size_t n = state.contact.size();
  nb::dict arrays;
  arrays["errors"] = arrayOf<double>(state.errors, {n, kNumTaskMeasures}, owner);
  arrays["within"] = arrayOf<bool>(state.within, {n}, owner);
  arrays["contact"] = arrayOf<bool>(state.contact, {n}, owner);
  arrays["travel"] = arrayOf<float>(state.travel, {n}, owner);
  arrays["laps"] = arrayOf<float>(state.laps, {n}, owner);
  arrays["peak_force"] = arrayOf<float>(state.peak_force, {n}, owner);
  arrays["num_losses"] = arrayOf<int>(state.num_losses, {n}, owner);
  return arrays;
}

}  // namespace taxelsim::python
