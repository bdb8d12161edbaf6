#include "frame_views.h"

#include <nanobind/stl/vector.h>

#include <initializer_list>
#include <type_traits>
#include <vector>

namespace taxelsim::python {
namespace {

template <typename Element>
const char* typeName() {
  if constexpr (std::is_same_v<Element, bool>) return "bool";
  if constexpr (std::is_same_v<Element, double>) return "float64";
  return std::is_same_v<Element, float> ? "float32" : "int32";
}

// An object with __dlpack__(), the shape, the name of the type.
template <typename Element>
nb::tuple deviceArray(Element* data, const std::vector<std::size_t>& shape, ArrayOwner owner) {
  using Value = std::remove_const_t<Element>;
  nb::ndarray<nb::array_api, Element> array(data, shape.size(), shape.data(), owner.object, nullptr, nb::dtype<Value>(), owner.device.type,
                                            owner.device.number);
  return nb::make_tuple(array.cast(), nb::tuple(nb::cast(shape)), typeName<Value>());
}

// The arrays of one view: rows first, then the shape of a row.
class Arrays {
 public:
  Arrays(std::vector<std::size_t> rows, ArrayOwner owner) : rows_(std::move(rows)), owner_(owner) {}

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
  void add(const nb::dict& others) { arrays_.update(others); }

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
    if (owner_.device.type == nb::device::cpu::value) {
      arrays_[name] = nb::ndarray<nb::numpy, const Element>(data, shape.size(), shape.data(), owner_.object).cast();
      return;
    }
    arrays_[name] = deviceArray(data, shape, owner_);
  }

  std::vector<std::size_t> rows_;
  ArrayOwner owner_;
  nb::dict arrays_;
};

// Shape of a row of a feature; of a derivative by a twist, whose last axis has six values.
std::vector<std::size_t> shapeOf(std::size_t width) {
  return width > 1 ? std::vector{width} : std::vector<std::size_t>{};
}
std::vector<std::size_t> shapeOfDerivative(std::size_t width) {
  return width > 6 ? std::vector<std::size_t>{width / 6, 6} : std::vector<std::size_t>{6};
}

// Statements that add the features of a table of taxelsim/feature_table.h to `arrays`, from `view`.
#define TAXELSIM_ADD(constant, name, offset, width, ...) arrays.add(#name, view.name, shapeOf(width));
#define TAXELSIM_ADD_PER_INSTANCE(constant, name, offset, width, ...) arrays.addPerInstance(#name, view.name, shapeOf(width));
#define TAXELSIM_ADD_DERIVATIVE(constant, name, offset, width, ...) arrays.add(#name, view.name, shapeOfDerivative(width));
#define TAXELSIM_ADD_WRENCH(constant, name, offset, width, ...) arrays.addPerInstance(#name, view.name, shapeOfDerivative(width));

void addFeatures(const FeatureView& view, Arrays& arrays) {
  TAXELSIM_IMAGE_FEATURES(TAXELSIM_ADD)
}

void addContact(const ContactFeatureView& view, std::size_t num_instances, ArrayOwner owner, Arrays& parent) {
  if (view.num_rows == 0) return;
  Arrays arrays({num_instances, static_cast<std::size_t>(view.num_rows)}, owner);
  addFeatures(view, arrays);
  TAXELSIM_CONTACT_FEATURES(TAXELSIM_ADD)
  TAXELSIM_REGION_FEATURES(TAXELSIM_ADD_PER_INSTANCE)
  parent.add("contact", arrays.take());
}

void addWrench(const TactileJacobianView&, Arrays&) {}
void addWrench(const CleanTactileJacobianView& view, Arrays& arrays) {
  TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_ADD_WRENCH)
}

template <typename View>
void addJacobian(const View& view, std::size_t num_instances, ArrayOwner owner, Arrays& parent) {
  if (view.num_rows == 0) return;
  Arrays arrays({num_instances, static_cast<std::size_t>(view.num_rows)}, owner);
  TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_ADD_DERIVATIVE)
  addWrench(view, arrays);
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

#define TAXELSIM_ADD_TAXELS(name, block, type, leading, components, ...) \
  addTaxels(#name, view.name, sensor, arrays, shapeOf(leading), shapeOf(components));

nb::dict groundTruthOf(const GroundTruthView& view, const Sensor& sensor, std::size_t num_instances, ArrayOwner owner) {
  Arrays arrays({num_instances}, owner);
  addFeatures(view, arrays);
  TAXELSIM_TRUE_TAXELS(TAXELSIM_ADD_TAXELS)
  TAXELSIM_TRUTH_FEATURES(TAXELSIM_ADD)
  addContact(view.contact, num_instances, owner, arrays);
  addJacobian(view.jacobian, num_instances, owner, arrays);
  return arrays.take();
}

}  // namespace

nb::dict imagesOf(const FrameView& view, const Sensor& sensor, std::vector<std::size_t> rows, ArrayOwner owner) {
  Arrays arrays(std::move(rows), owner);
  addTaxels("tactile_image", view.tactile_image, sensor, arrays);
  TAXELSIM_MEASURED_TAXELS(TAXELSIM_ADD_TAXELS)
  return arrays.take();
}

nb::dict arraysOf(const FrameView& view, const Sensor& sensor, int num_instances, ArrayOwner owner) {
  const auto n = static_cast<std::size_t>(num_instances);
  Arrays arrays({n}, owner);
  addFeatures(view, arrays);
  arrays.add(imagesOf(view, sensor, {n}, owner));
  TAXELSIM_READOUT_FEATURES(TAXELSIM_ADD)
  addContact(view.contact, n, owner, arrays);
  addJacobian(view.jacobian, n, owner, arrays);
  arrays.add("ground_truth", groundTruthOf(view.ground_truth, sensor, n, owner));
  return arrays.take();
}

nb::dict arraysOf(const ExportedInputs& inputs, int num_instances, ArrayOwner owner) {
  const auto n = static_cast<std::size_t>(num_instances);
  nb::dict arrays;
  if (!inputs.num_contacts.empty()) {
    const std::size_t room = inputs.normal_forces.size() / n;
    arrays["positions"] = deviceArray(inputs.positions.data(), {n, room, 3}, owner);
    arrays["normal_forces"] = deviceArray(inputs.normal_forces.data(), {n, room}, owner);
    arrays["num_contacts"] = deviceArray(inputs.num_contacts.data(), {n}, owner);
    return arrays;
  }
  const std::size_t num_slots = inputs.ids.size() / n;
  const auto of_slots = [&](std::vector<std::size_t> row) {
    if (num_slots > 1) row.insert(row.begin(), num_slots);
    row.insert(row.begin(), n);
    return row;
  };
  arrays["ids"] = deviceArray(inputs.ids.data(), of_slots({}), owner);
  arrays["poses"] = deviceArray(inputs.poses.data(), of_slots({7}), owner);
  arrays["loads"] = deviceArray(inputs.loads.data(), {n}, owner);
  return arrays;
}

}  // namespace taxelsim::python
