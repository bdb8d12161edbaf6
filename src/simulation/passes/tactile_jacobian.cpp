#include "simulation/passes/tactile_jacobian.h"

#include <algorithm>

#include "force_gradient_variants.h"
#include "mask_jacobian_variants.h"
#include "rescale_jacobian_variants.h"
#include "sensor/curve.h"
#include "spread_jacobian_variants.h"
#include "tactile_jacobian_variants.h"
#include "taxel_jacobian_variants.h"
#include "wrench_jacobian.spv.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kWorkgroup = gpu::DriverProfile::kIndependentWorkgroup;  // of the passes over taxels
constexpr std::uint32_t kMostJacobianSums = TactileJacobianInterface::kMostSums;
constexpr std::uint64_t kNumTwist = 6;  // coordinates

// Sources or receivers of a taxel that an invocation goes through: of a kernel once, of a list for each coordinate.
std::uint64_t numSpreads(const ModelData& model) {
  const auto kernel = static_cast<std::uint64_t>(model.sensor.psf.size);
  return model.packed.one_grid ? kernel * kernel : kNumTwist * model.packed.num_entries;
}

// Loop iterations that one invocation alone would take for a part.
std::uint64_t jacobianIterations(const ModelData& model) {
  constexpr std::uint64_t kNumScans = 8;  // over the taxels of a part, or tiles
  return model.num_taxels * (kNumScans + numSpreads(model) + kNumTwist) + kNumScans * kMostJacobianSums * model.packed_contact.lanes;
}

// Whether a taxel gives each of its sources what it takes from it: a spread by distance, or a kernel that is the same when it is turned by
// half a turn.
bool isSymmetric(const Psf& psf) {
  return psf.sigma > 0 || std::equal(psf.kernel.begin(), psf.kernel.end(), psf.kernel.rbegin());
}

// And for the gradient of an instance.
std::uint64_t gradientIterations(const ModelData& model) {
  const bool lists_once = !model.packed.one_grid && isSymmetric(model.sensor.psf);
  const std::uint64_t spreads = lists_once ? model.packed.num_entries : numSpreads(model);
  return model.num_taxels * (1 + spreads + kNumTwist) + ForceGradientInterface::kMostSums * model.packed_contact.lanes;
}

}  // namespace

void TactileJacobianPasses::recordTaxels(Recorder& recorder) const {
  const TaxelKernels& kernels = taxel_kernels_.get({}, [&] { return makeTaxelKernels(); });
  const std::uint64_t num_taxels = recorder.num_instances * model_.num_taxels;
  if (kernels.taxels) recorder.dispatch(*kernels.taxels, numWorkgroups(num_taxels, kWorkgroup));
  if (kernels.mask) recorder.dispatch(*kernels.mask, numWorkgroups(num_taxels, kWorkgroup));
  if (kernels.rescale) recorder.dispatch(*kernels.rescale, numWorkgroups(kNumTwist * recorder.num_instances, kWorkgroup));
}

void TactileJacobianPasses::recordWrench(Recorder& recorder) const {
  if (model_.layer) return;
  const auto& kernel = wrench_kernel_.get({}, [&] {
    return gpu::PassKernel<WrenchJacobianInterface>(
        model_.context(), "wrench_jacobian", k_wrench_jacobian_spirv,
        commonConstants(model_.sensor, model_.packed, {.workgroup = kWorkgroup, .lanes = model_.packed.contact_lanes}),
        WrenchJacobianInterface{.HAS_FORCES = !std::holds_alternative<Proximity>(model_.sensor.skin.law)});
  });
  recorder.dispatch(kernel, numWorkgroups(recorder.num_instances * model_.packed.tiles.size(), kWorkgroup));
}

void TactileJacobianPasses::recordSpread(Recorder& recorder) const {
  const auto& kernel = spread_kernel_.get({}, [&] {
    return gpu::PassKernel<SpreadJacobianInterface>(model_.context(), "spread_jacobian",
                                                    model_.profile.select(k_spread_jacobian_variants, gpu::DriverProfile::kNoneWaits),
                                                    commonConstants(model_.sensor, model_.packed, {.workgroup = kWorkgroup, .lanes = 1}),
                                                    SpreadJacobianInterface{.NUM_ENTRIES = model_.packed.num_entries});
  });
  recorder.dispatch(kernel, numWorkgroups(recorder.num_instances * model_.num_taxels, kWorkgroup));
}

void TactileJacobianPasses::recordFeatures(Recorder recorder, const Variant& variant) const {
  if (variant.clean) recorder.bindings.redirect<block::TactileJacobian, block::CleanTactileJacobian>();
  const FeatureKernel& features = feature_kernels_.get(variant, [&] { return makeFeatureKernel(variant); });
  // The row of a single patch is the sensor's.
  const std::uint64_t num_parts = model_.packed_contact.num_patches == 1 ? 1 : numContactRows(model_.packed_contact, 0);
  recorder.dispatch(features.kernel, numWorkgroups(recorder.num_instances * num_parts, features.parts_per_workgroup));
}

void TactileJacobianPasses::recordGradient(Recorder recorder, bool with_gains) const {
  if (!with_gains) recorder.bindings.redirect<block::ForceCotangents, block::Cotangents>();
  const GradientKernel& gradient = gradient_kernel_.get({}, [&] { return makeGradientKernel(); });
  recorder.dispatch(gradient.kernel, numWorkgroups(recorder.num_instances, gradient.instances_per_workgroup));
}

TactileJacobianPasses::TaxelKernels TactileJacobianPasses::makeTaxelKernels() const {
  const CommonConstants common = commonConstants(model_.sensor, model_.packed, {.workgroup = kWorkgroup, .lanes = 1});
  const bool scaled = model_.packed.scalesSpread();
  TaxelKernels kernels;
  if (!model_.layer) {
    kernels.taxels.emplace(model_.context(), "taxel_jacobian",
                           model_.profile.select(k_taxel_jacobian_variants, gpu::DriverProfile::kNoneWaits), common,
                           TaxelJacobianInterface{.SCALED = scaled && !model_.hasMask()});
  }
  if (model_.hasMask()) {
    kernels.mask.emplace(model_.context(), "mask_jacobian", model_.profile.select(k_mask_jacobian_variants, gpu::DriverProfile::kNoneWaits),
                         common, MaskJacobianInterface{.LAW_0 = model_.law.taxel_parameters[0], .MASK_SOURCES = model_.numMaskSources()});
    kernels.rescale.emplace(model_.context(), "rescale_jacobian",
                            model_.profile.select(k_rescale_jacobian_variants, gpu::DriverProfile::kNoneWaits), common,
                            RescaleJacobianInterface{.SCALED = scaled});
  }
  return kernels;
}

TactileJacobianPasses::FeatureKernel TactileJacobianPasses::makeFeatureKernel(const Variant& variant) const {
  const Readout& readout = model_.sensor.readout;
  const std::uint32_t lanes = model_.packed_contact.lanes;
  const TeamSizes sizes = teamSizes(wanted_workgroup_, model_.profile, jacobianIterations(model_), lanes, lanes);
  return {{model_.context(), "tactile_jacobian", model_.profile.select(k_tactile_jacobian_variants, sizes.pass.workgroup),
           commonConstants(model_.sensor, model_.packed, sizes.pass),
           TactileJacobianInterface{.CLEAN = variant.clean,
                                    .TEAM = sizes.team,
                                    .PATCHES = model_.packed_contact.num_patches,
                                    .LAST_PLANE = model_.sensor.patches.size(),
                                    .PARTIALS = sizes.numPartials(kMostJacobianSums),
                                    .NUM_ENTRIES = model_.packed.num_entries,
                                    .TRIGGER = readout.trigger,
                                    .SATURATION_FORCE = nominalForce(readout, readout.saturation) - readout.trigger,
                                    .RANDOM = variant.random,
                                    .DEAD_TAXEL_PROBABILITY = readout.dead_taxel_probability,
                                    .SAME_READOUT = readout.taxel_gain.empty() && readout.taxel_trigger.empty()}},
          sizes.itemsPerWorkgroup()};
}

TactileJacobianPasses::GradientKernel TactileJacobianPasses::makeGradientKernel() const {
  const std::uint32_t lanes = model_.packed_contact.lanes;
  const TeamSizes sizes = teamSizes(wanted_workgroup_, model_.profile, gradientIterations(model_), lanes, lanes);
  return {{model_.context(), "force_gradient", model_.profile.select(k_force_gradient_variants, sizes.pass.workgroup),
           commonConstants(model_.sensor, model_.packed, sizes.pass),
           ForceGradientInterface{.TEAM = sizes.team,
                                  .PARTIALS = sizes.numPartials(ForceGradientInterface::kMostSums),
                                  .NUM_ENTRIES = model_.packed.num_entries,
                                  .SYMMETRIC = isSymmetric(model_.sensor.psf)}},
          sizes.itemsPerWorkgroup()};
}

}  // namespace taxelsim
