#include "frame_views.h"

#include <nanobind/ndarray.h>

#include <initializer_list>
#include <type_traits>
#include <vector>

namespace taxelsim::python {
namespace {

// The arrays of one view: rows first, then the shape of a row.
class Arrays {
 public:
  Arrays(std::vector<std::size_t> rows, nb::handle owner) : rows_(std::move(rows)), owner_(owner) {}

  template <typename T>
  void add(const char* name, std::span<const T> values, const std::vector<std::size_t>& row = {}) {
    add(name, values, rows_, row);
  }
  // An array with one row per instance in a view that has more rows.
  template <typename T>
  void addPerInstance(const char* name, std::span<const T> values, const std::vector<std::size_t>& row = {}) {
    add(name, values, {rows_.front()}, row);
  }
  void add(const char* name, nb::handle value) { arrays_[name] = value; }

  nb::dict take() { return std::move(arrays_); }

 private:
  template <typename T>
  void add(const char* name, std::span<const T> values, std::vector<std::size_t> shape, const std::vector<std::size_t>& row) {
    if (values.empty()) return;
    shape.insert(shape.end(), row.begin(), row.end());
    // Counts are below 2^16, and libraries of tensors compute with signed integers.
    using Element = std::conditional_t<std::is_enum_v<T> || std::is_same_v<T, std::uint32_t>, std::int32_t, T>;
    static_assert(sizeof(Element) == sizeof(T));
    const auto* const data = reinterpret_cast<const Element*>(values.data());
    arrays_[name] = nb::ndarray<nb::numpy, const Element>(data, shape.size(), shape.data(), owner_).cast();
  }

  std::vector<std::size_t> rows_;
  nb::handle owner_;
  nb::dict arrays_;
};

void addFeatures(const FeatureView& view, Arrays& arrays) {
  arrays.add("total_force", view.total_force);
  arrays.add("peak_force", view.peak_force);
  arrays.add("center_of_pressure", view.center_of_pressure, {3});
  arrays.add("second_moments", view.second_moments, {3});
  arrays.add("eigenvalues", view.eigenvalues, {2});
  arrays.add("edge_angle", view.edge_angle);
  arrays.add("edge_confidence", view.edge_confidence);
  arrays.add("contact_area", view.contact_area);
}

void addContact(const ContactFeatureView& view, std::size_t num_instances, nb::handle owner, Arrays& parent) {
  if (view.num_rows == 0) return;
  Arrays arrays({num_instances, static_cast<std::size_t>(view.num_rows)}, owner);
  addFeatures(view, arrays);
  arrays.add("windowed_edge_angle", view.windowed_edge_angle);
  arrays.add("windowed_edge_confidence", view.windowed_edge_confidence);
  arrays.add("ridge_edge_angle", view.ridge_edge_angle);
  arrays.add("ridge_edge_confidence", view.ridge_edge_confidence);
  arrays.add("tilt", view.tilt, {2});
  arrays.add("tilt_confidence", view.tilt_confidence);
  arrays.add("contact_type", view.contact_type);
  arrays.add("patch", view.patch);
  arrays.addPerInstance("num_regions", view.num_regions);
  parent.add("contact", arrays.take());
}

void addJacobian(const TactileJacobianView& view, std::span<const float> contact_wrench, std::size_t num_instances, nb::handle owner,
                 Arrays& parent) {
  if (view.num_rows == 0) return;
  Arrays arrays({num_instances, static_cast<std::size_t>(view.num_rows)}, owner);
  arrays.add("center_of_pressure", view.center_of_pressure, {3, 6});
  arrays.add("total_force", view.total_force, {6});
  arrays.add("edge_angle", view.edge_angle, {6});
  arrays.addPerInstance("contact_wrench", contact_wrench, {6, 6});
  parent.add("jacobian", arrays.take());
}

// The taxels of an instance: (rows, columns) of a sensor with one patch, else a flat list. `shape`: of what comes before them; `vector`: of
// a taxel's values.
template <typename T>
void addTaxels(const char* name, std::span<const T> values, const Sensor& sensor, Arrays& arrays, std::vector<std::size_t> shape = {},
               const std::vector<std::size_t>& vector = {}) {
  if (sensor.patches.size() == 1) {
    shape.push_back(static_cast<std::size_t>(sensor.patches[0].num_rows));
    shape.push_back(static_cast<std::size_t>(sensor.patches[0].num_cols));
  } else {
    shape.push_back(static_cast<std::size_t>(numTaxels(sensor)));
  }
  shape.insert(shape.end(), vector.begin(), vector.end());
  arrays.add(name, values, shape);
}

nb::dict groundTruthOf(const GroundTruthView& view, const Sensor& sensor, std::size_t num_instances, nb::handle owner) {
  Arrays arrays({num_instances}, owner);
  addFeatures(view, arrays);
  addTaxels("tactile_normal_force", view.tactile_normal_force, sensor, arrays);
  addTaxels("penetration_depth", view.penetration_depth, sensor, arrays);
  addTaxels("taxel_jacobian", view.taxel_jacobian, sensor, arrays, {6});
  addTaxels("tactile_shear_force", view.tactile_shear_force, sensor, arrays, {}, {2});
  arrays.add("contact_wrench", view.contact_wrench, {6});
  arrays.add("over_penetration", view.over_penetration);
  arrays.add("load_offset", view.load_offset);
  arrays.add("load_reached", view.load_reached);
  arrays.add("off_array_load", view.off_array_load);
  arrays.add("off_array_contacts", view.off_array_contacts);
  arrays.add("contact_residual", view.contact_residual);
  arrays.add("contact_iterations", view.contact_iterations);
  addContact(view.contact, num_instances, owner, arrays);
  addJacobian(view.jacobian, view.jacobian.contact_wrench, num_instances, owner, arrays);
  return arrays.take();
}

}  // namespace

nb::dict arraysOf(const FrameView& frame, const Sensor& sensor, int num_instances, nb::handle owner) {
  const auto n = static_cast<std::size_t>(num_instances);
  Arrays arrays({n}, owner);
  addFeatures(frame, arrays);
  addTaxels("tactile_image", frame.tactile_image, sensor, arrays);
  addTaxels("taxel_counts", frame.taxel_counts, sensor, arrays, {}, {3});
  arrays.add("saturated", frame.saturated);
  addContact(frame.contact, n, owner, arrays);
  addJacobian(frame.jacobian, {}, n, owner, arrays);
  arrays.add("ground_truth", groundTruthOf(frame.ground_truth, sensor, n, owner));
  return arrays.take();
}

}  // namespace taxelsim::python
