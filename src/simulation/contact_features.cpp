// The passes over regions and contact features: shaders/contact_regions.comp, contact_features.comp.
#include <algorithm>
#include <bit>
#include <cstdint>

#include "contact_features.spv.h"
#include "contact_regions.spv.h"
#include "gpu/device_access.h"
#include "sensor/curve.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "simulation/model_impl.h"
#include "simulation/workgroups.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kMostSums = 16;     // of shaders/contact_features.comp
constexpr std::uint64_t kNumScans = 8;      // over the taxels of a part, at most
constexpr std::uint64_t kUniteTurns = 16;   // per taxel
constexpr std::uint64_t kInvertTurns = 64;  // of a curve that is no straight line

// Turns that one invocation alone would take for the regions of an instance.
std::uint64_t regionsWork(const Sensor& sensor, const PackedContactFeatures& packed, int max_regions) {
  std::uint64_t core = 0;
  for (const layout::PlaneRecord& plane : packed.planes) core = std::max<std::uint64_t>(core, 2 * plane.grid.w + 1);
  const std::uint64_t unite = kUniteTurns + 8ull * packed.num_neighbours;
  return static_cast<std::uint64_t>(numTaxels(sensor)) *
         (2 * core + unite + static_cast<std::uint64_t>(max_regions) + (isStraight(sensor.readout) ? 0 : kInvertTurns));
}

// The same for a part.
std::uint64_t partWork(const Sensor& sensor, const PackedContactFeatures& packed) {
  return kNumScans * (static_cast<std::uint64_t>(numTaxels(sensor)) + 2ull * kMostSums * packed.lanes);
}

}  // namespace

const Model::Impl::ContactFeaturePasses& Model::Impl::contactFeatures(const ContactFeatureVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = contact_features_.find(variant);
  if (found != contact_features_.end()) return found->second;
  return contact_features_.emplace(variant, makeContactFeatures(variant)).first->second;
}

Model::Impl::ContactFeaturePasses Model::Impl::makeContactFeatures(const ContactFeatureVariant& variant) const {
  constexpr std::uint32_t kTaxelsPerInvocation = 4;
  const DeviceInfo& info = device.info();
  const Readout& readout = sensor.readout;
  const auto regions = static_cast<std::uint32_t>(variant.max_regions);
  // On a software driver every invocation has an instance or a part of its own, unless that would be too many turns for it.
  const auto team = [&](std::uint64_t work, std::uint32_t workgroup, std::uint32_t most) {
    const bool alone = info.type == DeviceType::kCpu && image_workgroup_wanted == 0 && work <= kMaxTurns;
    return alone ? 1u : std::min(workgroup, most);
  };
  const std::uint64_t regions_work = regionsWork(sensor, packed_contact, variant.max_regions);
  const std::uint32_t regions_workgroup = chooseWorkgroup(image_workgroup_wanted, info, 64, regions_work, "image_workgroup");
  const std::uint32_t regions_team = team(regions_work, regions_workgroup, std::bit_ceil(num_taxels / kTaxelsPerInvocation + 1));
  const std::uint32_t regions_repeat = chooseRepeat(info, regions_work / regions_team);

  const std::uint64_t part_work = partWork(sensor, packed_contact);
  const std::uint32_t parts_workgroup = chooseWorkgroup(image_workgroup_wanted, info, 64, part_work, "image_workgroup");
  const std::uint32_t parts_team = team(part_work, parts_workgroup, packed_contact.lanes);
  const std::uint32_t parts_repeat = chooseRepeat(info, part_work / parts_team);
  const std::uint32_t num_partials = parts_team == 1 ? 1 : parts_workgroup / parts_team * kMostSums * packed_contact.lanes;
  const std::uint32_t first_count = layout::kNumContactFeatures * numContactRows(packed_contact, variant.max_regions);
  return {
      {gpu::contextOf(device),
       {.name = "contact_regions",
        .spirv = k_contact_regions_spirv,
        .buffers = {"Instances", "Step", "SensorBlock", "Taxels", "Planes", "Neighbours", "Image", "SpreadNormal", "Forces", "TaxelRegions",
                    "RegionSums", "Regions", "ContactFeatures", "Problems"},
        .constants = constants(sensor, packed, {regions_workgroup, 1, regions_repeat},
                               {variant.clean, regions_team, regions, packed_contact.num_neighbours, packed_contact.force_steps,
                                first_count, sensor.patches.size() == 1, static_cast<std::uint32_t>(readout.curve.size()),
                                bits(slopeAtZero(readout)), bits(readout.output_scale), bits(readout.trigger), bits(readout.saturation),
                                bits(readout.curve_limit), static_cast<std::uint32_t>(readout.curve_points.size())})}},
      {gpu::contextOf(device),
       {.name = "contact_features",
        .spirv = k_contact_features_spirv,
        .buffers = {"Instances", "Step", "Taxels", "Planes", "Forces", "TaxelRegions", "Regions", "ContactFeatures", "Problems"},
        .constants =
            constants(sensor, packed, {parts_workgroup, packed_contact.lanes, parts_repeat},
                      {variant.clean, parts_team, regions, packed_contact.num_patches, static_cast<std::uint32_t>(sensor.patches.size()),
                       num_partials, bits(readout.noise), bits(slopeAtZero(readout) * readout.output_scale), bits(packed_contact.stiffness),
                       bits(packed_contact.exponent)})}},
      regions_workgroup / regions_team * regions_repeat,
      parts_workgroup / parts_team * parts_repeat,
  };
}

}  // namespace taxelsim
