// Batches of sensor instances. Python's Simulator checks arrays before it calls the class here.
#include "taxelsim/simulator.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "frame_views.h"
#include "handles.h"
#include "shared_arrays.h"
#include "structs.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

using Ids = nb::ndarray<const int, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Poses = nb::ndarray<const double, nb::shape<-1, 7>, nb::c_contig, nb::device::cpu>;
using WritablePoses = nb::ndarray<double, nb::shape<-1, 7>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<const double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
using Mask = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Floats = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using FloatResults = nb::ndarray<float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Episodes = nb::ndarray<const std::uint64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(ContactPoint) == 4 * sizeof(double));

template <typename Element, typename Array>
std::span<const Element> rows(const Array& array) {
  return {reinterpret_cast<const Element*>(array.data()), array.shape(0)};
}

// A Simulator that several Python threads may call: calls wait for each other, without the GIL.
class SharedSimulator {
 public:
  // `platform`: interface of the GPU that outputs are shared with, if any.
  SharedSimulator(const Model& model, const SimulatorOptions& options, std::optional<interop::Platform> platform)
      : simulator_(model, exporting(options, platform.has_value())) {
    if (platform) shared_.emplace(simulator_.get(), *platform);
  }
  ~SharedSimulator() {
    const nb::gil_scoped_release release;  // waits for the device if a step is unread
    const std::lock_guard lock(mutex_);
  }

  // Calls `use(simulator)` without the GIL. Inputs may not change while the device reads them.
  template <typename Use>
  auto input(const char* method, Use use) {
    const WithoutGil released;
    const std::lock_guard lock(mutex_);
    if (running_) throw std::logic_error(std::string(method) + "() between step() and read(): call read() first");
    return use(simulator_.get());
  }

  // `mask`: instances that begin an episode, empty for all; see Simulator::step().
  void step(double dt, std::span<const std::uint8_t> mask) {
    input("step", [&](Simulator& simulator) {
      if (shared_) shared_->get().holdNextStep();
      if (mask.empty()) {
        simulator.step(dt);
      } else {
        simulator.step(dt, mask);
      }
      if (shared_) shared_->get().stepSubmitted();
      running_ = true;
    });
  }

  // With shared outputs the streams of consumers wait, and the host goes on.
  FrameView read() {
    const WithoutGil released;
    const std::lock_guard lock(mutex_);
    running_ = false;
    if (!shared_) return simulator_.get().read();
    shared_->get().releaseStep();
    return shared_->get().frame();
  }

  // Calls `use(shared outputs)` without the GIL.
  template <typename Use>
  auto withShared(Use use) {
    const WithoutGil released;
    const std::lock_guard lock(mutex_);
    return use(requireShared(shared_ ? &shared_->get() : nullptr));
  }

  // The device that has the memory of the arrays.
  ArrayDevice device() const { return shared_ ? shared_->get().device() : ArrayDevice(); }

  StepTiming timing() {
    const std::lock_guard lock(mutex_);
    return simulator_.get().timing();
  }

  DeviceTraffic traffic() {
    const std::lock_guard lock(mutex_);
    return simulator_.get().traffic();
  }

  const Model& model() const { return simulator_.get().model(); }
  int numInstances() const { return simulator_.get().numInstances(); }

 private:
  static SimulatorOptions exporting(SimulatorOptions options, bool exports) {
    options.export_memory = exports;
    return options;
  }

  std::mutex mutex_;
  Owned<Simulator> simulator_;
  std::optional<Owned<SharedArrays>> shared_;  // destroyed first
  bool running_ = false;                       // a step is unread
};

void reset(SharedSimulator& self, const Ids& instances, const Episodes& episodes, float gain, float gain_spread, float noise) {
  self.input("reset", [&](Simulator& simulator) {
    for (std::size_t k = 0; k < instances.shape(0); ++k) {
      simulator.reset(instances.data()[k], episodes.data()[k], {.gain = gain, .gain_spread = gain_spread, .noise = noise});
    }
  });
}

void setContacts(SharedSimulator& self, const Points& contacts, const Ids& offsets) {
  self.input("set_contacts", [&](Simulator& simulator) { simulator.setContacts(rows<ContactPoint>(contacts), rows<int>(offsets)); });
}

// `gain`: empty for 1. Results: `twist` (N x 6), `by_gain` (N x num_taxels).
void vjp(SharedSimulator& self, const Floats& cotangent, const Floats& gain, const FloatResults& twist, const FloatResults& by_gain) {
  self.input("vjp", [&](Simulator& simulator) {
    const GradientView gradient = simulator.vjp(rows<float>(cotangent), rows<float>(gain));
    if (twist.size() != gradient.twist.size() || by_gain.size() != gradient.gain.size()) throw std::logic_error("vjp(): wrong results");
    std::copy(gradient.twist.begin(), gradient.twist.end(), twist.data());
    std::copy(gradient.gain.begin(), gradient.gain.end(), by_gain.data());
  });
}

// Moves each object so that its anchor, by default its lowest point, lies where `poses` has its origin. Rows that setObjects() refuses
// stay.
void placeByAnchor(const ModelHandle& model, const Ids& ids, const WritablePoses& poses, const std::optional<Vector3>& anchor) {
  const WithoutGil released;
  const std::vector<Object>& objects = model.get().objects();
  int last_id = -1;
  Quaternion last_rotation{};
  Vector3 lowest{};
  for (std::size_t i = 0; i < ids.shape(0); ++i) {
    const int id = ids.data()[i];
    double* const pose = poses.data() + 7 * i;
    const double length = std::hypot(std::hypot(pose[3], pose[4]), std::hypot(pose[5], pose[6]));
    if (id < 0 || id >= static_cast<int>(objects.size()) || !(length > 0)) continue;
    const Quaternion rotation{pose[3] / length, pose[4] / length, pose[5] / length, pose[6] / length};
    if (!anchor && (id != last_id || rotation != last_rotation)) {
      lowest = lowestPoint(objects[static_cast<std::size_t>(id)], rotation);
      last_id = id;
      last_rotation = rotation;
    }
    const Vector3 offset = rotate(rotation, anchor.value_or(lowest));
    for (std::size_t axis = 0; axis < 3; ++axis) pose[axis] -= offset[axis];
  }
}

void bindOptions(nb::module_& module) {
  nb::class_<OutputOptions> outputs(module, "OutputOptions",
                                    "Optional outputs of a Simulator. Features and the tactile image are always computed.");
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    addFields(outputs, field(kOutputs[I].name, kOutputs[I].member, kOutputs[I].text)...);
  }
  (std::make_index_sequence<std::size(kOutputs)>());
  nb::dict where;
  for (const OutputEntry& output : kOutputs) where[output.name] = output.where;
  module.attr("OUTPUTS") = where;
  nb::class_<SimulatorOptions> options(module, "SimulatorOptions", "Options of a Simulator.");
  addFields(options, field("num_instances", &SimulatorOptions::num_instances, "N, >= 1."),
            field("num_slots", &SimulatorOptions::num_slots, "Objects per instance, 1 to 8."),
            field("seed", &SimulatorOptions::seed, "Key of all random numbers."),
            field("outputs", &SimulatorOptions::outputs, "Optional outputs."),
            field("max_contacts", &SimulatorOptions::max_contacts, "Capacity for contact points of one instance, 0 to 4096."),
            field("max_regions", &SimulatorOptions::max_regions, "Rows of contact features for regions, 0 to 8."),
            field("contact_band", &SimulatorOptions::contact_band, "m, height above the skin up to which contact points count."),
            field("device_clock", &SimulatorOptions::device_clock, "Whether timing reports seconds."));
  nb::enum_<interop::Platform>(module, "Platform", "Interface of a GPU that outputs are shared with.")
      .value("CUDA", interop::Platform::kCuda, "CUDA's driver.")
      .value("HIP", interop::Platform::kHip, "HIP. Untested.");
  nb::enum_<ContactType>(module, "ContactType", nb::is_arithmetic(), "Type of a contact; values of frame.contact.contact_type.")
      .value("NONE", ContactType::kNone, "No contact above the noise.")
      .value("POINT", ContactType::kPoint, "Length at most 2.5 taxels.")
      .value("EDGE", ContactType::kEdge, "Width at most half the length.")
      .value("AREA", ContactType::kArea, "Any other contact.");
  nb::class_<MemoryPlan> plan(module, "MemoryPlan", "Device memory of a simulator, for planning.");
  addFields(plan, field("bytes_per_instance", &MemoryPlan::bytes_per_instance, "Bytes per instance in a batch of this size."),
            field("bytes_fixed", &MemoryPlan::bytes_fixed, "Bytes independent of the number of instances."),
            field("max_instances", &MemoryPlan::max_instances, "Most instances that fit the device."));
  nb::class_<StepTiming> timing(module, "StepTiming", "Times of the last frame by the device's clock, s; NaN without device_clock.");
  addFields(timing, field("contact", &StepTiming::contact, "s, contact pass."),
            field("image", &StepTiming::image, "s, image pass, contact features and tactile Jacobian."),
            field("total", &StepTiming::total, "s, all passes."),
            field("num_coherent", &StepTiming::num_coherent, "Instances that tested only triangles found near by an earlier step."));
  nb::class_<DeviceTraffic> traffic(module, "DeviceTraffic", "What a Simulator has exchanged with its device since its construction.");
  addFields(traffic, field("num_submits", &DeviceTraffic::num_submits, "Submissions to the queue: one per step() and per vjp()."),
            field("bytes_to_device", &DeviceTraffic::bytes_to_device, "Bytes that the host has written to the memory of the device."),
            field("bytes_from_device", &DeviceTraffic::bytes_from_device, "Bytes of the outputs of every step() and vjp()."));
}

}  // namespace

void bindSimulator(nb::module_& module) {
  bindOptions(module);
  module.def(
      "plan", [](const ModelHandle& model, const SimulatorOptions& options) { return Simulator::plan(model.get(), options); }, "model"_a,
      "options"_a, "Device memory that a Simulator with these options would take. Allocates nothing.");
  module.def("place_by_anchor", &placeByAnchor, "model"_a, "ids"_a, "poses"_a, "anchor"_a.none());
  nb::class_<SharedSimulator> batch(module, "Simulator", "The batch behind taxelsim.Simulator.");
  bindShared(batch);
  batch
      .def(
          "__init__",
          [](SharedSimulator* self, const ModelHandle& model, const SimulatorOptions& options, std::optional<interop::Platform> platform) {
            new (self) SharedSimulator(model.get(), options, platform);
          },
          "model"_a, "options"_a, "platform"_a.none(), nb::call_guard<WithoutGil>())
      .def(
          "set_objects",
          [](SharedSimulator& self, const Ids& ids, const Poses& poses) {
            self.input("set_objects", [&](Simulator& simulator) { simulator.setObjects(rows<int>(ids), rows<Pose>(poses)); });
          },
          "ids"_a, "poses"_a)
      .def(
          "set_loads",
          [](SharedSimulator& self, const Floats& loads) {
            self.input("set_loads", [&](Simulator& simulator) { simulator.setLoads(rows<float>(loads)); });
          },
          "loads"_a)
      .def("set_contacts", &setContacts, "contacts"_a, "offsets"_a)
      .def("reset", &reset, "instances"_a, "episodes"_a, "gain"_a, "gain_spread"_a, "noise"_a)
      .def(
          "prepare", [](SharedSimulator& self, bool loads) { self.input("prepare", [&](Simulator& s) { s.prepare(loads); }); }, "loads"_a)
      .def(
          "step", [](SharedSimulator& self, double dt) { self.step(dt, {}); }, "dt"_a)
      .def(
          "step", [](SharedSimulator& self, double dt, const Mask& mask) { self.step(dt, rows<std::uint8_t>(mask)); }, "dt"_a, "mask"_a)
      .def("vjp", &vjp, "cotangent"_a, "gain"_a, "twist"_a, "by_gain"_a)
      .def("read", [](SharedSimulator& self) { self.read(); })
      .def(
          "arrays",
          [](nb::handle self) {
            auto& simulator = nb::cast<SharedSimulator&>(self);
            return arraysOf(simulator.read(), simulator.model().sensor(), simulator.numInstances(), {self, simulator.device()});
          },
          nb::sig("def arrays(self) -> dict[str, typing.Any]"))
      .def(
          "inputs",
          [](nb::handle self) {
            auto& simulator = nb::cast<SharedSimulator&>(self);
            const ExportedInputs inputs = simulator.withShared([](SharedArrays& shared) { return shared.inputs(); });
            return arraysOf(inputs, simulator.numInstances(), {self, simulator.device()});
          },
          nb::sig("def inputs(self) -> dict[str, typing.Any]"))
      .def_prop_ro("timing", &SharedSimulator::timing)
      .def_prop_ro("traffic", &SharedSimulator::traffic);
}

}  // namespace taxelsim::python
