// Devices.
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <variant>

#include "handles.h"
#include "structs.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

DeviceHandle openDevice(const std::variant<std::string, int>& device, bool validation, bool keep_kernels) {
  const int* const index = std::get_if<int>(&device);
  return DeviceHandle(Device::open(
      {.device = index ? std::to_string(*index) : std::get<std::string>(device), .validation = validation, .keep_kernels = keep_kernels}));
}

}  // namespace

void bindDevice(nb::module_& module) {
  nb::enum_<DeviceType>(module, "DeviceType", "Type of a device, as its driver reports it.")
      .value("DISCRETE", DeviceType::kDiscrete, "GPU with its own memory.")
      .value("INTEGRATED", DeviceType::kIntegrated, "GPU that shares the host's memory.")
      .value("VIRTUAL", DeviceType::kVirtual, "Virtual GPU.")
      .value("CPU", DeviceType::kCpu, "Software Vulkan on the processor.")
      .value("OTHER", DeviceType::kOther, "None of these.");
  nb::class_<DeviceInfo> info(module, "DeviceInfo", "Description of a device.");
  addFields(info, field("index", &DeviceInfo::index, "Position in list_devices(), from 0."),
            field("name", &DeviceInfo::name, "Name that the driver gives the device."),
            field("type", &DeviceInfo::type, "Type that the driver reports."),
            field("driver", &DeviceInfo::driver, "Name and version of the driver."),
            field("api_version", &DeviceInfo::api_version, "Vulkan version, \"1.3.230\"."),
            field("uuid", &DeviceInfo::uuid, "UUID of the device, hexadecimal."),
            field("memory", &DeviceInfo::memory, "Bytes of the largest device-local heap."),
            field("max_buffer", &DeviceInfo::max_buffer, "Bytes that one storage buffer can hold."),
            field("subgroup_size", &DeviceInfo::subgroup_size, "Invocations of a subgroup."),
            field("shared_memory", &DeviceInfo::shared_memory, "Bytes of shared memory per workgroup."));
  nb::class_<DeviceHandle>(module, "Device", R"(An open Vulkan device. Made by Device.open().

May be used from several threads at once. It does not survive fork().)")
      .def_static("open", &openDevice, "device"_a = "", nb::kw_only(), "validation"_a = false, "keep_kernels"_a = true,
                  nb::call_guard<WithoutGil>(), R"(Opens a device. Waits.

device: "gpu" (the best that is not a CPU), "discrete", "integrated", "cpu", an index into list_devices(), or part of a name. Empty: the
    environment variable TAXELSIM_DEVICE if set, else the best device.
validation: enables the Vulkan validation layers.
keep_kernels: stores compiled kernels in the user's cache folder.

Raises DeviceError if no device matches.)")
      .def_prop_ro(
          "info", [](const DeviceHandle& device) { return device.get().info(); }, "Description of the device.")
      .def("__repr__", [](const DeviceHandle& device) { return "<taxelsim.Device " + device.get().info().name + ">"; });
  module.def("list_devices", &listDevices, nb::call_guard<WithoutGil>(),
             "All devices that can run taxelsim, best first. Raises DeviceError without Vulkan.");
}

}  // namespace taxelsim::python
