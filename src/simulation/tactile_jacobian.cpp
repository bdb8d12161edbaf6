// The passes of the tactile Jacobian: shaders/taxel_jacobian.comp, mask_jacobian.comp, rescale_jacobian.comp, tactile_jacobian.comp.
#include <algorithm>
#include <cstdint>

#include "gpu/device_access.h"
#include "mask_jacobian.spv.h"
#include "rescale_jacobian.spv.h"
#include "simulation/model_impl.h"
#include "simulation/workgroups.h"
#include "tactile_jacobian.spv.h"
#include "taxel_jacobian.spv.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kMostSums = 7;   // of shaders/tactile_jacobian.comp
constexpr std::uint64_t kNumScans = 14;  // over the taxels of a part, or tiles, at most

// Turns that one invocation alone would take for a part.
std::uint64_t partWork(const Sensor& sensor, const PackedSensor& packed, std::uint32_t lanes) {
  const std::uint64_t sources = packed.one_grid ? static_cast<std::uint64_t>(sensor.psf.size * sensor.psf.size) : packed.num_entries;
  const auto taxels = static_cast<std::uint64_t>(numTaxels(sensor));
  return taxels * (kNumScans + 6 * sources) + kNumScans * kMostSums * lanes;
}

}  // namespace

const std::vector<gpu::Kernel>& Model::Impl::taxelJacobian() const {
  const std::lock_guard lock(kernels_mutex_);
  if (!taxel_jacobian_.empty()) return taxel_jacobian_;
  taxel_jacobian_.emplace_back(gpu::contextOf(device),
                               gpu::KernelOptions{.name = "taxel_jacobian",
                                                  .spirv = k_taxel_jacobian_spirv,
                                                  .buffers = {"Step", "Patches", "Tiles", "Taxels", "SpreadScale", "ContactCells",
                                                              "TileChanges", "TaxelJacobian", "WrenchJacobian"},
                                                  .constants = constants(sensor, packed, {kTaxelWorkgroup, packed.contact_lanes, 1},
                                                                         {packed.scalesSpread() && !masksForces(),
                                                                          !std::holds_alternative<Proximity>(sensor.skin.law)})});
  if (!masksForces()) return taxel_jacobian_;
  taxel_jacobian_.emplace_back(
      gpu::contextOf(device),
      gpu::KernelOptions{.name = "mask_jacobian",
                         .spirv = k_mask_jacobian_spirv,
                         .buffers = {"Step", "Mask", "Taxels", "LawState", "TaxelJacobian", "MaskedJacobian"},
                         .constants = constants(sensor, packed, {kTaxelWorkgroup, 1, 1}, {bits(law.taxel_parameters[0])})});
  taxel_jacobian_.emplace_back(
      gpu::contextOf(device),
      gpu::KernelOptions{.name = "rescale_jacobian",
                         .spirv = k_rescale_jacobian_spirv,
                         .buffers = {"Step", "SpreadScale", "LawState", "TileResults", "MaskedJacobian", "TaxelJacobian", "Problems"},
                         .constants = constants(sensor, packed, {kTaxelWorkgroup, 1, 1}, {packed.scalesSpread()})});
  return taxel_jacobian_;
}

const Model::Impl::JacobianPass& Model::Impl::tactileJacobian(const JacobianVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = tactile_jacobian_.find(variant);
  if (found != tactile_jacobian_.end()) return found->second;
  return tactile_jacobian_.emplace(variant, makeTactileJacobian(variant)).first->second;
}

Model::Impl::JacobianPass Model::Impl::makeTactileJacobian(const JacobianVariant& variant) const {
  const DeviceInfo& info = device.info();
  const Readout& readout = sensor.readout;
  const std::uint32_t lanes = packed_contact.lanes;
  const std::uint64_t work = partWork(sensor, packed, lanes);
  const std::uint32_t workgroup = chooseWorkgroup(image_workgroup_wanted, info, 64, work, "image_workgroup");
  // On a software driver every invocation has a part of its own, unless that would be too many turns for it.
  const bool alone = info.type == DeviceType::kCpu && image_workgroup_wanted == 0 && work <= kMaxTurns;
  const std::uint32_t team = alone ? 1u : std::min(workgroup, lanes);
  const std::uint32_t repeat = chooseRepeat(info, work / team);
  const std::uint32_t num_partials = team == 1 ? 1 : workgroup / team * kMostSums * lanes;
  const double most = nominalForce(readout, readout.saturation) - readout.trigger;
  return {{gpu::contextOf(device),
           {.name = "tactile_jacobian",
            .spirv = k_tactile_jacobian_spirv,
            .buffers = {"Instances", "Step", "Taxels", "Planes", "SpreadRows", "SpreadNormal", "TaxelJacobian", "WrenchJacobian",
                        "TactileJacobian", "Problems"},
            .constants =
                constants(sensor, packed, {workgroup, lanes, repeat},
                          {variant.clean, team, packed_contact.num_patches, static_cast<std::uint32_t>(sensor.patches.size()), num_partials,
                           packed.num_entries, bits(readout.trigger), bits(most), variant.random, bits(readout.dead_taxel_probability)})}},
          workgroup / team * repeat};
}

}  // namespace taxelsim
