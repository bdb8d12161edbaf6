// Models: a sensor and objects on a device.
#include "taxelsim/model.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <variant>
#include <vector>

#include "any_object.h"
#include "bind.h"
#include "handles.h"
#include "interruptible.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

using AnySensor = std::variant<Sensor, std::filesystem::path>;

Sensor sensorOf(const AnySensor& sensor) {
  const auto* const file = std::get_if<std::filesystem::path>(&sensor);
  return file ? loadSensor(*file) : std::get<Sensor>(sensor);
}

void makeModel(ModelHandle* self, const DeviceHandle& device, const AnySensor& sensor, const std::vector<AnyObject>& objects,
               int contact_workgroup, int image_workgroup) {
  const Device& opened = device.get();
  const ModelOptions options = loadInterruptibly([&] {
    ModelOptions read{
        .sensor = sensorOf(sensor), .objects = {}, .contact_workgroup = contact_workgroup, .image_workgroup = image_workgroup};
    for (const AnyObject& object : objects) read.objects.push_back(objectOf(object));
    return read;
  });
  const WithoutGil released;
  new (self) ModelHandle(opened, options);
}

}  // namespace

void bindModel(nb::module_& module) {
  nb::class_<ModelHandle>(module, "Model", R"(A sensor and the objects that it may touch, on a device. Immutable.

Any number of simulators share a model, in any thread.)")
      .def("__init__", &makeModel, "device"_a, "sensor"_a, "objects"_a = std::vector<AnyObject>{}, nb::kw_only(), "contact_workgroup"_a = 0,
           "image_workgroup"_a = 0, R"(Uploads the objects. Waits.

device: an open Device.
sensor: a Sensor, or a sensor file.
objects: objects, shapes, or texts of parse_object(), such as a mesh file in metres; referred to by index in Simulator.set_objects(). May be
    empty for contact points.
contact_workgroup, image_workgroup: invocations per workgroup, a power of two from 4 to 256; 0: the best for the device. Results do not
    depend on them.

Raises InputError for a sensor or an object that is not valid, DeviceError if memory runs out.)")
      .def_prop_ro(
          "sensor", [](const ModelHandle& model) -> Sensor { return model.get().sensor(); }, "The sensor.")
      .def_prop_ro(
          "objects", [](const ModelHandle& model) -> std::vector<Object> { return model.get().objects(); }, "The objects.")
      .def_prop_ro(
          "device", [](const ModelHandle& model) { return DeviceHandle(model.get().device()); }, "The device.")
      .def("__repr__", [](const ModelHandle& model) {
        return "<taxelsim.Model " + model.get().sensor().name + ", " + std::to_string(model.get().objects().size()) + " objects>";
      });
}

}  // namespace taxelsim::python
