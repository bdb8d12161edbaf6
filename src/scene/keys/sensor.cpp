#include "scene/keys/sensor.h"

#include <numbers>

#include "geometry/object_fields.h"
#include "scene/sensor_file.h"
#include "scene/taxel_reader.h"
#include "sensor/fields.h"

namespace taxelsim {
namespace {

constexpr std::string_view kPerTaxel = "one per taxel in storage order (patch by patch, row by row), or a list of rows";

Key perTaxelKey(std::string_view key, const Allowed& allowed, std::string otherwise, const std::string& text) {
  return {key, Numbers{.allowed = allowed, .count = kAnyNumber, .in_rows = true}, std::move(otherwise),
          text + ", " + std::string(kPerTaxel)};
}

std::string termList(int max_terms) {
  return "a list of at most " + std::to_string(max_terms) + " of {fraction, time}";
}

template <typename Term, std::size_t N>
const Block& termKeys(const std::array<Field<Term>, N>& fields) {
  static const Block block{.name = "", .keys = keysOfFields(fields)};
  return block;
}
const Block& relaxationKeys() {
  return termKeys(kRelaxationFields);
}
const Block& creepKeys() {
  return termKeys(kCreepFields);
}

Key gridKey(std::string_view key, std::string otherwise, const char* text) {
  return {key, Numbers{.allowed = Allowed::above(0, "m"), .count = 2, .or_one = true}, std::move(otherwise), text};
}

KeyTable gridKeys() {
  return joinKeys(
      keysOfFields(kGridPatchFields),
      KeyTable{gridKey("pitch[_mm]", kNeeded, "Distance of the taxels, along x and along y"),
               {"pose", Nested{poseKeys}, "identity", "Pose of the middle of the grid in the sensor frame S; z points out of the skin"}});
}

// Makes keys optional which others can replace.
KeyTable optional(KeyTable keys) {
  for (Key& key : keys) {
    if (key.otherwise == kNeeded) key.otherwise = "";
  }
  return keys;
}

template <typename Law>
Block::Case lawCase(std::size_t index, const Law& law) {
  KeyTable keys;
  visitFields(law, [&](const auto& table) { keys = joinKeys(keys, keysOfFields(table)); });
  if constexpr (std::is_same_v<Law, ElasticLayer>) {
    keys.insert(keys.begin() + kElasticLayerFields.size(),
                {"base", Words{kBaseNames}, "bonded", "bonded: a layer of `thickness` on a rigid board; half_space: infinitely thick"});
    keys = joinKeys(keys, keysOfFields(kMarginFields));
  }
  return {kLawNames[index], std::move(keys)};
}

template <std::size_t... I>
std::vector<Block::Case> lawCases(std::index_sequence<I...>) {
  return {lawCase(I, std::variant_alternative_t<I, ContactLaw>{})...};
}

}  // namespace

KeyTable fileKeys(std::string format_version) {
  return {{"format_version", Number{Allowed::within(1, kFormatVersion, ""), true}, std::move(format_version), "Version of the format"},
          {"name", Text{"a name"}, kNeeded, "Name in messages and data sets, 1 to 200 bytes"}};
}

Key sha256Key() {
  return {"sha256", Text{"64 hexadecimal digits"}, "", "SHA-256 that the bytes of the file must have"};
}

Key upAxisKey() {
  return {"up_axis", Words{kUpAxisNames}, "z", "Axis of the file that becomes z"};
}

const Block& rotationKeys() {
  static const Block block{.name = "rotation",
                           .keys = {{"rotation", Numbers{Allowed::within(-1 - kUnitTolerance, 1 + kUnitTolerance, ""), 4}, "[1, 0, 0, 0]",
                                     "Unit quaternion w, x, y, z"},
                                    {"rpy[_deg]", Numbers{Allowed::within(-2 * std::numbers::pi, 2 * std::numbers::pi, "rad"), 3}, "",
                                     "Instead of it: roll about x, then pitch about y, then yaw about z, all fixed axes"}}};
  return block;
}

const Block& poseKeys() {
  static const Block block{
      .name = "pose",
      .keys = joinKeys(KeyTable{{"position[_mm]", Numbers{Allowed::any("m"), 3}, "[0, 0, 0]", "Position x, y, z"}}, rotationKeys().keys)};
  return block;
}

const Block& patchKeys() {
  static const Block block{
      .name = "patch",
      .keys = joinKeys(KeyTable{{"name", Text{"a name"}, "patch_0, patch_1, ...", "Name, unlike those of the other patches"}}, gridKeys())};
  return block;
}

const Block& taxelKeys() {
  static const Block block{
      .name = "taxel",
      .keys = {{"position[_mm]", Numbers{Allowed::any("m"), 3}, kNeeded, "Middle of the taxel in S, on the undeformed outer skin"},
               {"normal", Numbers{Allowed::any(""), 3}, kNeeded, "Direction in S out of the skin, of any length but 0"},
               gridKey("size[_mm]", kNeeded, "Side of a square, or sides along x and along y"),
               {"x_axis", Numbers{Allowed::any(""), 3}, "x of S, rotated by the shortest rotation from z of S to the normal",
                "Direction in S whose projection into the plane of the taxel is x"}}};
  return block;
}

const Block& taxelMeshKeys() {
  static const Block block{.name = "",
                           .keys = joinKeys(KeyTable{{"file", Text{"a mesh file"}, kNeeded, "Mesh with two triangles per taxel"}},
                                            keysOfFields(kMeshScaleFields), KeyTable{upAxisKey(), sha256Key()})};
  return block;
}

const Block& taxelUrdfKeys() {
  static const Block block{
      .name = "",
      .keys = {{"file", Text{"a URDF file"}, kNeeded, "URDF with the sensor"},
               {"sensor", Text{"the name of a tactile sensor in the URDF"}, kNeeded, "Name of a <sensor> with <tactile>"},
               sha256Key()}};
  return block;
}

const Block& skinKeys() {
  static const Block block{
      .name = "skin",
      .keys =
          joinKeys(keysOfFields(kSkinFields), KeyTable{{"law", Words{kLawNames}, "winkler", "Contact law; keys of other laws are refused"}},
                   withDefault(keysOfFields(kFrictionFields), "tangential_stiffness", "required with friction"),
                   KeyTable{{"relaxation", NestedList{termList(kMaxRelaxationTerms), relaxationKeys}, "[]",
                             "At a constant depth the force falls: the stiffness is multiplied by 1 - sum fraction (1 - e^(-t / time))"}}),
      .selector = "law",
      .cases = lawCases(std::make_index_sequence<kLawNames.size()>())};
  return block;
}

const Block& gaussianKeys() {
  static const Block block{.name = "",
                           // A smaller sigma spreads nothing; a larger one is flat over the largest kernel.
                           .keys = {{"sigma", Number{Allowed::within(1e-3, 100, "taxels")}, kNeeded, "Width"},
                                    {"size", Number{Allowed::within(1, kMaxKernelSize, ""), true}, kNeeded,
                                     "Taxels per side of the square on which it is sampled, odd"}}};
  return block;
}

const Block& skinGaussianKeys() {
  static const Block block{.name = "", .keys = withDefault(keysOfFields(kSkinGaussianFields), "reach", "3 sigma")};
  return block;
}

const Block& psfKeys() {
  static const Block block{
      .name = "psf",
      .keys = {{"gaussian", Nested{gaussianKeys}, "", "A Gaussian, sampled on the taxels of a grid"},
               {"skin_gaussian", Nested{skinGaussianKeys}, "",
                "A Gaussian of the distance along the skin over all taxels within reach, also of other patches; at most 128 per taxel"},
               {"kernel", Numbers{.allowed = Allowed::atLeast(0, ""), .count = kAnyNumber, .in_rows = true}, "[[1]]",
                "Rows of weights: square, odd, at most 9 x 9, sum > 0"},
               {"normalization", Words{kNormalizationNames}, "per_source",
                "per_source keeps the sum of forces, also at borders; none uses the kernel unchanged"}}};
  return block;
}

const Block& curveKeys() {
  static const Block block{
      .name = "",
      .keys = joinKeys(KeyTable{{"counts_per_newton", Number{Allowed::above(0, "counts/N")}, "", "Slope of a straight curve"},
                                {"coefficients", Numbers{Allowed::any("counts/N^m"), kAnyNumber}, "",
                                 "1 to 5 coefficients of x, x^2, ...; the curve must rise over the range used"},
                                {"points", Numbers{.allowed = Allowed::above(0, ""), .count = kAnyNumber, .in_rows = true}, "",
                                 "Straight pieces from (0, 0) through up to 16 points [N, counts], both ascending; the first piece extends "
                                 "below 0, the last one beyond the last point"}},
                       keysOfFields(kCurveLimitFields)),
      .one_of = {"counts_per_newton", "coefficients", "points"}};
  return block;
}

const Block& threeAxisKeys() {
  static const Block block{
      .name = "three_axis",
      .keys = joinKeys(
          KeyTable{
              {"gain", Numbers{.allowed = Allowed::within(-kMaxAxisGain, kMaxAxisGain, "counts/N"), .count = kAnyNumber, .in_rows = true},
               kNeeded, "Three rows (output of x, y, normal) of three numbers (force along x, y, normal); off the diagonal is cross-talk"}},
          keysOfFields(kThreeAxisFields))};
  return block;
}

const Block& readoutKeys() {
  static const Block block{
      .name = "readout",
      .keys = joinKeys(
          KeyTable{{"curve", Nested{curveKeys}, kNeeded, "Counts against x = gain F - trigger"}},
          withDefault(keysOfFields(kOutputFields), "trigger", "3 standard deviations of the noise; 0 with taxel_trigger"),
          KeyTable{{"saturation", Number{Allowed::within(1, (1 << kMaxAdcBits) - 1, ""), true}, "2^adc_bits - 1", "Largest counts"}},
          keysOfFields(kNoiseFields),
          KeyTable{perTaxelKey("taxel_gain", Allowed::atLeast(0, ""), "all 1", "Gains"),
                   perTaxelKey("taxel_trigger", Allowed::any("N"), "all trigger", "Triggers"),
                   perTaxelKey("calibrated_gain", Allowed::atLeast(0, ""), "all 1",
                               "Gains that a calibration found; the feature ridge_edge_angle divides by them and leaves out 0"),
                   {"hysteresis_strength", Numbers{Allowed::within(0, 1, ""), kAnyNumber, true}, "[]",
                    "At most 4 strengths w, sum < 1: F = (1 - sum w) x + sum w play_r(x)"},
                   {"hysteresis_width", Numbers{Allowed::atLeast(0, "N"), kAnyNumber, true}, "[]",
                    "As many widths r: the output of unloading is up to 2 w r larger than that of loading"},
                   {"creep", NestedList{termList(kMaxCreepTerms), creepKeys}, "[]",
                    "The output of a constant force F is F (1 + sum fraction (1 - e^(-t / time)))"}},
          keysOfFields(kTimeFields), keysOfFields(kImperfectionFields),
          KeyTable{{"three_axis", Nested{threeAxisKeys}, "none", "Electronics of three-axis taxels; needs a skin with friction"}})};
  return block;
}

const Block& sensorKeys() {
  static const Block block{
      .name = "sensor",
      .keys = joinKeys(fileKeys(kNeededInFile),
                       KeyTable{{"patches", NestedList{"a list of patches", patchKeys}, "", "Several grids, instead of the keys of one"},
                                {"taxels", NestedList{"a list of at least one taxel", taxelKeys}, "",
                                 "Taxels with individual poses, at most " + std::to_string(kMaxListTaxels)},
                                {"taxel_mesh", Nested{taxelMeshKeys}, "", "Taxels with individual poses, as the quadrilaterals of a mesh"},
                                {"urdf", Nested{taxelUrdfKeys}, "", "Taxels with individual poses, from a URDF"}},
                       optional(gridKeys()), keysOfFields(kFrameRateFields), keysOfFields(kSensorFields),
                       KeyTable{{"depth_sampling", Words{kDepthSamplingNames}, "point",
                                 "point: the depth of a sample is that at the middle of its cell; area: the mean depth over its cell"},
                                {"skin", Nested{skinKeys}, kNeeded, "Skin"},
                                {"psf", Nested{psfKeys}, "no spread", "Point spread function"},
                                {"readout", Nested{readoutKeys}, kNeeded,
                                 "Electronics: counts = clip(round(output_scale y(x) + noise), 0, saturation)"}}),
      .one_of = {"num_rows", "patches", "taxels", "taxel_mesh", "urdf"}};
  return block;
}

}  // namespace taxelsim
