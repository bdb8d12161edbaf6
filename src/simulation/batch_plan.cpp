#include "simulation/batch_plan.h"

#include <algorithm>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Part of the device's memory that a batch may take; the rest is for the driver and other programs.
constexpr double kMemoryShare = 0.9;

// Bytes of one instance.
struct InstanceBytes {
  std::uint64_t total = 0;    // in all arrays and the copies that the host reads
  std::uint64_t largest = 0;  // in one array
};

InstanceBytes instanceBytes(const BatchShape& shape) {
  InstanceBytes sum;
  for (const BatchArray& array : batchArrays()) {
    if (!array.per_instance) continue;
    const std::uint64_t bytes = array.bytes(shape);
    const bool is_copied = array.isForHost(shape.options) && shape.model.profile.copiesResults();
    sum.total += is_copied ? 2 * bytes : bytes;
    sum.largest = std::max(sum.largest, bytes);
  }
  return sum;
}

// Arrays of every batch, whatever its size. The few words of results that a batch has once are left out.
std::uint64_t fixedBytes(const ModelData& model) {
  return model.buffers.bytes() + sizeof(layout::StepRecord);
}

// Instances that fit into the device.
std::uint64_t roomFor(const BatchShape& shape) {
  const DeviceInfo& info = shape.model.device.info();
  const InstanceBytes bytes = instanceBytes(shape);
  const auto memory = static_cast<std::uint64_t>(static_cast<double>(info.memory) * kMemoryShare);
  const std::uint64_t fixed = fixedBytes(shape.model);
  const std::uint64_t by_memory = memory > fixed ? (memory - fixed) / bytes.total : 0;
  // Workgroup numbers are 32-bit.
  const std::uint64_t by_number = 0xFFFFFFFFu / std::max<std::uint64_t>(1, shape.model.contact_packed.tiles.size());
  return std::min({by_memory, info.max_buffer / bytes.largest, by_number, std::uint64_t{0x7FFFFFFF}});
}

void checkRegions(const SimulatorOptions& options) {
  const auto refuse = [&](const std::string& allowed) {
    throw Error(ErrorKind::kInput, "max_regions: " + std::to_string(options.max_regions) + " is not allowed: " + allowed);
  };
  if (options.max_regions < 0 || options.max_regions > kMaxRegions) refuse("0 to " + std::to_string(kMaxRegions));
  const bool with_features = options.outputs.contact_features || options.outputs.clean_contact_features;
  if (options.max_regions > 0 && !with_features) refuse("0 without outputs.contact_features or outputs.clean_contact_features");
}

void checkJacobian(const SimulatorOptions& options) {
  const auto* const wanted = derivativeIn(options.outputs);
  if (wanted == std::end(kOutputs)) return;
  const auto refuse = [&](const char* why) {
    throw Error(ErrorKind::kInput, std::string("outputs.") + wanted->name + ": true is not allowed " + why);
  };
  if (options.max_contacts > 0) refuse("where max_contacts > 0: contacts do not determine how forces change with a motion");
  if (options.vary_skin) refuse("where vary_skin is true: it has no factors per instance");
}

void checkTaxelCounts(const ModelData& model, const SimulatorOptions& options) {
  if (!options.outputs.taxel_counts) return;
  const auto refuse = [](const char* why) {
    throw Error(ErrorKind::kInput, std::string("outputs.taxel_counts: true is not allowed ") + why);
  };
  if (!model.sensor.readout.three_axis) refuse("for a sensor without readout.three_axis");
  if (options.max_contacts > 0) refuse("where max_contacts > 0: contacts have no shear");
}

// Objects or contacts.
void checkSource(const ModelData& model, const SimulatorOptions& options) {
  constexpr double kMaxContactBand = 1;  // m
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::kInput, what); };
  if (options.max_contacts < 0 || options.max_contacts > kMaxContacts) {
    refuse("max_contacts: " + std::to_string(options.max_contacts) + " is not allowed: 0 to " + std::to_string(kMaxContacts));
  }
  // Written so that NaN fails.
  if (!(options.contact_band >= 0 && options.contact_band <= kMaxContactBand)) {
    refuse("contact_band: " + std::to_string(options.contact_band) + " is not allowed: 0 to 1 m");
  }
  if (options.max_contacts == 0 && model.objects.empty()) {
    refuse("objects: none given; a model needs at least one, unless its simulators take contacts (max_contacts)");
  }
  if (options.max_contacts > 0 && options.vary_skin) {
    refuse("vary_skin: true is not allowed where max_contacts > 0: contacts do not press on a skin");
  }
  if (options.max_contacts > 0 && options.outputs.penetration_depth) {
    refuse("outputs.penetration_depth: true is not allowed where max_contacts > 0: contacts do not determine it");
  }
}

}  // namespace

BatchShape shapeOf(const ModelData& model, const BatchOptions& options) {
  const BatchShape with_candidates{model, options, true};
  const bool can_keep = model.keeps_candidates && options.max_contacts == 0;
  if (can_keep && static_cast<std::uint64_t>(options.num_instances) <= roomFor(with_candidates)) return with_candidates;
  return {model, options, false};
}

MemoryPlan planBatch(const ModelData& model, const BatchOptions& options) {
  MemoryPlan plan;
  plan.bytes_per_instance = instanceBytes(shapeOf(model, options)).total;
  plan.bytes_fixed = fixedBytes(model);
  plan.max_instances = roomFor({model, options, false});
  return plan;
}

void checkBatchFits(const ModelData& model, const BatchOptions& options) {
  if (options.num_instances < 1) {
    throw Error(ErrorKind::kInput, "num_instances: " + std::to_string(options.num_instances) + " is not allowed: at least 1");
  }
  if (options.num_slots < 1 || options.num_slots > kMaxSlots) {
    throw Error(ErrorKind::kInput,
                "num_slots: " + std::to_string(options.num_slots) + " is not allowed: 1 to " + std::to_string(kMaxSlots));
  }
  checkSource(model, options);
  checkRegions(options);
  checkJacobian(options);
  checkTaxelCounts(model, options);
  if (options.export_memory && !model.context().exports().memory) {
    throw Error(ErrorKind::kDevice, "export_memory: the driver of device \"" + model.device.info().name + "\" exports no memory");
  }
  const MemoryPlan plan = planBatch(model, options);
  if (static_cast<std::uint64_t>(options.num_instances) <= plan.max_instances) return;
  throw Error(ErrorKind::kInput, "a batch of " + std::to_string(options.num_instances) + " instances of " +
                                     std::to_string(plan.bytes_per_instance) + " bytes does not fit into device \"" +
                                     model.device.info().name + "\": at most " + std::to_string(plan.max_instances) + " do");
}

}  // namespace taxelsim
