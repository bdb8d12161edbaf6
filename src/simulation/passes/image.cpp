#include "simulation/passes/image.h"

#include <algorithm>
#include <string>

#include "image_variants.h"
#include "sensor/curve.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Loop iterations per taxel of stage 4 and the imperfections: elements, terms, and the rounds of each draw.
std::uint64_t iterationsOfTime(const Readout& readout) {
  constexpr std::uint64_t kRounds = 10;
  const auto draws = static_cast<std::uint64_t>((readout.bias > 0) + (readout.random_walk > 0) + (readout.dead_taxel_probability > 0));
  return readout.hysteresis_strength.size() + readout.creep.size() + kRounds * draws;
}

// Loop iterations that one invocation alone would take for an instance.
std::uint64_t imageIterations(const ModelData& model) {
  constexpr std::uint64_t kLinearCurve = 8, kCurve = 64;  // of a taxel's readout
  const Sensor& sensor = model.sensor;
  const std::uint64_t sources =
      model.packed.one_grid ? static_cast<std::uint64_t>(sensor.psf.size * sensor.psf.size) : model.packed.num_entries;
  return model.num_taxels * (sources + (isLinear(sensor.readout) ? kLinearCurve : kCurve) + iterationsOfTime(sensor.readout));
}

std::uint32_t numPartials(const TeamSizes& sizes) {
  return sizes.numPartials(ImageInterface::kNumSums);
}

void checkFits(const DeviceInfo& info, const TeamSizes& sizes) {
  const std::uint32_t bytes = 4 * numPartials(sizes);
  if (bytes <= info.shared_memory) return;
  throw Error(ErrorKind::kInput, "tuning.image_team: " + std::to_string(sizes.team) + " is not allowed: in workgroups of " +
                                     std::to_string(sizes.pass.workgroup) + " takes " + std::to_string(bytes) +
                                     " bytes of shared memory, the device has " + std::to_string(info.shared_memory));
}

}  // namespace

ImagePass::ImagePass(const ModelData& model, const ModelOptions& options, const Tuning& tuning) : model_(model) {
  const std::uint64_t iterations = imageIterations(model);
  const std::uint32_t lanes = model.packed.image_lanes;
  sizes_ = teamSizes(options.image_workgroup, model.profile, iterations, lanes, lanes);
  if (tuning.image_team != 0) {
    sizes_.team = tunedSize(tuning.image_team, sizes_.team, 1, sizes_.pass.workgroup, "tuning.image_team");
    checkFits(model.device.info(), sizes_);
    sizes_.pass.repeat = model.profile.itemsInSequence(iterations / sizes_.team, kMaxRepeat);
  }
  sizes_.pass.repeat = tunedRepeat(tuning.image_repeat, sizes_.pass.repeat, "tuning.image_repeat");
}

void ImagePass::record(Recorder recorder, const Variant& variant) const {
  if (variant.masked) recorder.bindings.redirect<block::ContactNormal, block::MaskedNormal>();
  recorder.bindings.redirect<block::ForceFours, block::ContactNormal>();
  recorder.bindings.redirect<block::PastTaxelStates, block::TaxelStates>();
  recorder.dispatch(kernels_.get(variant, [&] { return makeKernel(variant); }),
                    numWorkgroups(recorder.num_instances, sizes_.itemsPerWorkgroup()));
}

ImagePass::Kernel ImagePass::makeKernel(const Variant& variant) const {
  const Readout& readout = model_.sensor.readout;
  const PackedSensor& packed = model_.packed;
  const bool taxels_alike = std::all_of(packed.taxels.begin(), packed.taxels.end(), [&](const layout::TaxelRecord& taxel) {
    return taxel.readout.x == 1.0f && taxel.readout.y == static_cast<float>(readout.trigger);
  });
  const bool reads_at_rest =
      std::any_of(packed.taxels.begin(), packed.taxels.end(), [](const layout::TaxelRecord& taxel) { return taxel.readout.y < 0; });
  return {model_.context(), "image", model_.profile.select(k_image_variants, gpu::DriverProfile::kNoneWaits),
          commonConstants(model_.sensor, packed, sizes_.pass),
          ImageInterface{.SHEAR = variant.with_shear,
                         .NUM_ENTRIES = packed.num_entries,
                         .OUTPUT_NORMAL = variant.with_normal,
                         .TAXELS_ALIKE = taxels_alike,
                         .CURVE_DEGREE = readout.curve.size(),
                         .CURVE_SLOPE = slopeAtZero(readout),
                         .OUTPUT_SCALE = readout.output_scale,
                         .TRIGGER = readout.trigger,
                         .SATURATION = static_cast<double>(readout.saturation),
                         .NOISE = readout.noise,
                         .RANDOM = variant.random,
                         .TEAM = sizes_.team,
                         .PARTIALS = numPartials(sizes_),
                         .NUM_HYSTERESIS = readout.hysteresis_strength.size(),
                         .NUM_CREEP = readout.creep.size(),
                         .LOW_PASS = readout.low_pass_time > 0,
                         .DELAY = readout.delay > 0,
                         .RANDOM_WALK = readout.random_walk > 0,
                         .BIAS = readout.bias,
                         .DEAD_TAXEL_PROBABILITY = readout.dead_taxel_probability,
                         .WHOLE_ARRAY = variant.whole_array,
                         .ROTATES_SHEAR = packed.rotates_shear,
                         .CURVE_LIMIT = readout.curve_limit,
                         .CURVE_PIECES = readout.curve_points.size(),
                         .KEEPS_WINDOW = model_.profile.paths().untouched && model_.sensor.frame_rate == 0,
                         .RANDOM_SKIN = variant.random_skin,
                         .SCALED = packed.scalesSpread(),
                         .READS_AT_REST = reads_at_rest,
                         .MARGIN = variant.masked ? 1u : 0u}};
}

}  // namespace taxelsim
