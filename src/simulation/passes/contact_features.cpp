#include "simulation/passes/contact_features.h"

#include <algorithm>
#include <bit>

#include "contact_features_variants.h"
#include "contact_regions_variants.h"
#include "sensor/curve.h"
#include "shared/features.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kMostPartSums = ContactFeaturesInterface::kMostSums;

// Loop iterations that one invocation alone would take for the regions of an instance.
std::uint64_t regionIterations(const ModelData& model, int max_regions) {
  constexpr std::uint64_t kUnite = 16, kUnitePerNeighbour = 8;  // per taxel
  constexpr std::uint64_t kInvertCurve = 64;                    // per taxel, unless the curve is a straight line
  const PackedContactFeatures& packed = model.packed_contact;
  std::uint64_t core = 0;
  for (const layout::PlaneRecord& plane : packed.planes) core = std::max<std::uint64_t>(core, 2 * plane.grid.w + 1);
  const std::uint64_t unite = kUnite + kUnitePerNeighbour * packed.num_neighbours;
  return model.num_taxels *
         (2 * core + unite + static_cast<std::uint64_t>(max_regions) + (isLinear(model.sensor.readout) ? 0 : kInvertCurve));
}

// The same for a part.
std::uint64_t partIterations(const ModelData& model) {
  constexpr std::uint64_t kNumScans = 7;  // over the taxels of a part, at most
  return kNumScans * (model.num_taxels + 2ull * kMostPartSums * model.packed_contact.lanes);
}

}  // namespace

void ContactFeaturePasses::record(Recorder recorder, bool clean, int max_regions) const {
  if (clean) {
    recorder.bindings.redirect<block::ContactFeatures, block::CleanContactFeatures>();
    recorder.bindings.redirect<block::FeatureSource, block::CleanFeatureSource>();
    recorder.bindings.redirect<block::Image, block::SpreadNormal>();
  }
  const Kernels& kernels = kernels_.get(max_regions, [&] { return makeKernels(max_regions); });
  recorder.dispatch(kernels.regions, numWorkgroups(recorder.num_instances, kernels.regions_per_workgroup));
  // The row of a single patch is the sensor's.
  const std::uint64_t num_parts = numContactRows(model_.packed_contact, max_regions) - (model_.packed_contact.num_patches == 1 ? 1 : 0);
  recorder.dispatch(kernels.features,
                    numWorkgroups(recorder.num_instances, kernels.features_per_workgroup) * static_cast<std::uint32_t>(num_parts));
}

ContactFeaturePasses::Kernels ContactFeaturePasses::makeKernels(int max_regions) const {
  constexpr std::uint32_t kTaxelsPerInvocation = 4, kNoLanes = 1;
  const TeamSizes regions = teamSizes(wanted_workgroup_, model_.profile, regionIterations(model_, max_regions), kNoLanes,
                                      std::bit_ceil(model_.num_taxels / kTaxelsPerInvocation + 1));
  const std::uint32_t lanes = model_.packed_contact.lanes;
  const TeamSizes features = teamSizes(wanted_workgroup_, model_.profile, partIterations(model_), lanes, lanes);
  return {makeRegions(max_regions, regions), makeFeatures(max_regions, features), regions.itemsPerWorkgroup(),
          features.itemsPerWorkgroup()};
}

gpu::PassKernel<ContactRegionsInterface> ContactFeaturePasses::makeRegions(int max_regions, const TeamSizes& sizes) const {
  const Readout& readout = model_.sensor.readout;
  const PackedContactFeatures& packed = model_.packed_contact;
  return {model_.context(), "contact_regions", model_.profile.select(k_contact_regions_variants, sizes.pass.workgroup),
          commonConstants(model_.sensor, model_.packed, sizes.pass),
          ContactRegionsInterface{.TEAM = sizes.team,
                                  .REGIONS = max_regions,
                                  .NUM_NEIGHBOURS = packed.num_neighbours,
                                  .FORCE_STEPS = packed.force_steps,
                                  .FIRST_COUNT = layout::kNumContactFeatures * numContactRows(packed, max_regions),
                                  .NUM_PATCHES = model_.sensor.patches.size(),
                                  .CURVE_DEGREE = readout.curve.size(),
                                  .CURVE_SLOPE = slopeAtZero(readout),
                                  .OUTPUT_SCALE = readout.output_scale,
                                  .TRIGGER = readout.trigger,
                                  .SATURATION = static_cast<double>(readout.saturation),
                                  .CURVE_LIMIT = readout.curve_limit,
                                  .CURVE_PIECES = readout.curve_points.size()}};
}

gpu::PassKernel<ContactFeaturesInterface> ContactFeaturePasses::makeFeatures(int max_regions, const TeamSizes& sizes) const {
  const Readout& readout = model_.sensor.readout;
  const PackedContactFeatures& packed = model_.packed_contact;
  return {model_.context(), "contact_features", model_.profile.select(k_contact_features_variants, sizes.pass.workgroup),
          commonConstants(model_.sensor, model_.packed, sizes.pass),
          ContactFeaturesInterface{.TEAM = sizes.team,
                                   .REGIONS = max_regions,
                                   .PATCHES = packed.num_patches,
                                   .LAST_PLANE = model_.sensor.patches.size(),
                                   .PARTIALS = sizes.numPartials(kMostPartSums),
                                   .NOISE = readout.noise,
                                   .SLOPE = slopeAtZero(readout) * readout.output_scale,
                                   .STIFFNESS = packed.stiffness,
                                   .EXPONENT = packed.exponent}};
}

}  // namespace taxelsim
