#include "option_limits.h"

#include <algorithm>
#include <variant>

namespace taxelsim::bench {
namespace {

constexpr double kWord = 4;          // bytes
constexpr double kExponential = 10;  // operations of exp, log and cos
constexpr double kTransform = 18;    // shaders/common/transform.glsl, apply(): three rows of 3 products and 3 sums
constexpr double kBounds = 33;       // the same, boundsOfImage(): apply() and three dot products of 5

// ---- pose ----

constexpr double kPoseBytes = 64;      // shaders/shared/batch.h, PoseRecord
constexpr double kInstanceBytes = 32;  // the same, InstanceRecord: drive and keys

// ---- depths: shaders/depth/ ----

// solids.glsl, a cylinder: y of the sample 2; ray into O, of which x and z are those of the row, 1 + 6; insideInfiniteCylinder(): middle
// 4, closest point 4, distance 4, reach 2, both ends 2; slab() 4.
constexpr double kCylinderSample = 2 + 7 + 16 + 4;
// mesh.glsl, boxReaches(): middle 9, half size 6, boundsOfImage(), box in samples 8, height 3.
constexpr double kBox = 9 + 6 + kBounds + 8 + 3;
constexpr double kBoxesOfGroup = 32, kQuadsOfBox = 4;  // shaders/shared/model.h
constexpr double kQuadFetch = 4 * (3 + kTransform);    // mesh.glsl, vertexOf() of four vertices
// raster.glsl, rasterBySamples(): origin 8, three edge functions 9, areas 10, slopes 10, steps 12.
constexpr double kQuadSetup = 8 + 9 + 10 + 10 + 12;
// The same, a sample that is covered: two edge functions 4, signs 6, next sample 5; height 4, over the tile's base 1.
constexpr double kQuadSample = 4 + 6 + 5 + 4 + 1;

// solid_cells.glsl: position 2, tubeUnder() 37, quadraticUnder() 11, placeOf() 9.
constexpr double kTubeCell = 2 + 37 + 11 + 9;
constexpr double kInsideCell = 5;  // integralInside()
// integralOf(): on each of four lines the parabola 7, positivePart() 24, addSums() 2; divideSums() 2.
constexpr double kEdgeCell = 4 * (7 + 24 + 2) + 2;
constexpr double kGiveCell = 5;  // cell_depths.glsl, giveCell()
// facets.glsl: corners in cells 16 per quad; per triangle facetOf() 17 and ratesOf() of three edges 12.
constexpr double kQuadInCells = 16, kFacet = 17 + 3 * 4;
// facets.glsl, addEdge() of three edges 46 each, addOutlineCell(): centroid 4, depth 6, integrals 1, addToSums() 4.
constexpr double kFacetCell = 3 * 46 + 4 + 6 + 1 + 4;
constexpr double kTakeSums = 2;  // cell_depths.glsl, takeSums()
// How depths vary over a cell, where friction, an exponent or elastic_layer needs it: integralInside() 24; per line 26 + 4 + 3; second
// moments of three edges 51 each and their integrals 30; variationOf() or edgeOf() and packedCentroid() 15.
constexpr double kVariationInside = 24, kVariationEdge = 4 * 33, kVariationFacet = 3 * 51 + 30, kVariationCell = 15;

// ---- forces: shaders/skin/tile_pressures.glsl ----

// pressTaxel(), per sample: height over the base and depth 2, pressure 1, sums of force 1, moment 4, depth 1 and full depth 1.
constexpr double kForceSample = 2 + 1 + 1 + 4 + 1 + 1;
constexpr double kForceTaxel = 1 + 2 + 3 + 1;  // writeTaxel(): force, moment, wrench, scale of the spread

// ---- image: shaders/readout/ ----

// spread.glsl, 3 x 3 weights 17; readout.glsl, countsOf() 6, nominalForce() 3; taxel.glsl, chartOf() 4; addForce() twice 12.
constexpr double kImageTaxel = 17 + 6 + 3 + 4 + 2 * 12;

// ---- features: shaders/features/ ----

constexpr double kAngle = 27;                             // axes.glsl, angleOf(): ratio 1, halving 5, square 1, series 9 x 2, end 2
constexpr double kAxes = 2 + 6 + 2 + 2 + kAngle + 1 + 3;  // axesOf()
constexpr double kCentral = 11;                           // moments.glsl, centralMoments()
constexpr double kMoments = kCentral + 22 + kAxes;        // writeMoments(): centralMoments(), centre in S, axesOf()
constexpr double kFeatures = 2 * kMoments + 2;            // of the measured and the clean image; two shares
constexpr double kFeatureBytes = 36 * kWord;              // shaders/shared/features.h: without those of elastic_layer and contact points

// ---- states of samples and taxels ----

constexpr double kRectangleBytes = 2 * 16;  // shaders/skin/sample_states.glsl: a rectangle of taxels, read and written
constexpr double kInOut = 2 * kWord;        // a word of state, read and written
constexpr double kDampingSample = 2 + 2;    // tile_pressures.glsl, depthRate(); law.glsl, damping
constexpr double kMotionBytes = 64;         // shaders/shared/batch.h, MotionRecord
constexpr double kCone = 11;                // shaders/common/transform.glsl
// friction.glsl, shearTraction(): displacement, share of the step 1; tile_pressures.glsl, addPoint(): factor 1, sums 10.
constexpr double kDraggedSample = kTransform + 1 + 1 + 10;
constexpr double kSpringSample = 6 + 1 + kCone;  // friction.glsl, springTraction() and its cap
// law.glsl, bristleShear(): length, direction and speed 8, Stribeck's curve 4, g and x 4, relaxed() 18, state 8, traction 12, cone,
// pressure 2; two exponentials.
constexpr double kBristleSample = 8 + 4 + 4 + 18 + 8 + 12 + kCone + 2 + 2 * kExponential;
constexpr double kShearTaxel = 2 + 3 + 3 + 2;       // tile_pressures.glsl, writeTaxel()
constexpr double kRelaxSample = 7, kRelaxTerm = 6;  // sample_states.glsl, skinAt(), relaxedPressure(), updateSkin(); per term

// mass_spring_damper.comp: distance from rest 1, two rows of exp(A dt) 6, state 2, scale 1.
constexpr double kMassTaxel = 1 + 6 + 2 + 1;
// deformation_mask.comp: nine sources, limit 1, sum 1, scale 2.
constexpr double kMaskTaxel = 9 * 2 + 1 + 3;

// lag.glsl: hysteresis() per element, creep() per term, approach() of the low-pass.
constexpr double kHysteresis = 5, kCreep = 5, kLowPass = 3;
// common/philox.glsl: ten rounds of 2 products and 2 sums; uniformNumber() 1; gaussian() 6 more, a root, a logarithm and a cosine.
constexpr double kUniform = 10 * 4 + 1, kGaussian = 10 * 4 + 5 + 1 + 2 * kExponential;

// ---- contact features: shaders/features/ ----

constexpr double kPosition = 8;  // contact_parts.glsl, positionOf()
// contact_sums.glsl, addTaxel(), per scan: forces; second moments with those of the core; four windows; ridge.glsl, addToRidge(), twice.
constexpr double kScanTaxel = (kPosition + 7) + (kPosition + 2 + 10 + 19) + 4 * (kPosition + 2 + 3 + 2 + kExponential + 11) +
                              2 * (kPosition + 4 + 8 + 3 + 9 + 12 + 1 + kExponential + 5 + 6 + 30 + 14);
// Per row: writeMoments(); windowedAxes(), four centres 15 each; ridge_edge.glsl, two solutions 249 each and an angle; tilt.glsl 60;
// contact_type.glsl 40; axesOf() of windows, ridge and type.
constexpr double kContactRow = kMoments + 4 * 15 + 2 * 249 + kAngle + 60 + 40 + 3 * kAxes;
constexpr double kContactRowBytes = 22 * kWord;  // shaders/shared/features.h, kNumContactFeatures
constexpr double kRegionTaxel = 3;               // region_bits.glsl, takeRegion()

// ---- tactile Jacobian ----

// cell_fluxes.glsl: stepOfDepth() along two axes and their length 12, meanSlope() 6, stiffnessAt() 4, addSample() 14.
constexpr double kFluxSample = 12 + 6 + 4 + 14;
constexpr double kFluxRow = 40;                          // addRow(), per row of samples
constexpr double kFluxTaxel = 15 + 15 + 28;              // addToChange(); writeCell(); taxel_jacobian.comp
constexpr double kReadingTaxel = 4 + kPosition + 5 + 8;  // jacobian_parts.glsl, readingOf(); jacobian_sums.glsl, addTaxel()
// jacobian_sums.glsl, momentsBy(): nine receivers, position, weight 2, moments 13; addChanges(): 6 coordinates of 6 moments.
constexpr double kJacobianTaxel = 9 * (kPosition + 2 + 13) + 6 * 6 * 2;
constexpr double kJacobianRow = 6 * (20 + 15);     // jacobian_sums.glsl, changeOf(), writeChange()
constexpr double kJacobianBytes = 2 * 30 * kWord;  // shaders/shared/features.h, kNumJacobian, of the sensor and its patch

// ---- elastic_layer ----

constexpr double kProduct = 2;  // elastic_layer/influence.glsl, displacementAt(): a product and a sum
// elastic_layer/: targets 2, first pressures and residual 7, updateResidual() 6.
constexpr double kLayerStart = 2 + 7 + 6;
// elastic_layer/solver.glsl, an iteration: updateDirection() 5, applyToDirection() 2, takeStep() 8, updateResidual() 6.
constexpr double kLayerIteration = 5 + 2 + 8 + 6;
constexpr double kLayerFeatureBytes = 3 * kWord;  // off_array_load, contact_residual, contact_iterations
// elastic_layer/relaxation.glsl: dentAt() 3, updateSkin() 2; per term 4 and 2.
constexpr double kLayerRelaxNode = 5, kLayerRelaxTerm = 6;

bool isArea(const Sensor& sensor) {
  return sensor.depth_sampling == DepthSampling::kArea;
}
bool isLayer(const Sensor& sensor) {
  return std::holds_alternative<ElasticLayer>(sensor.skin.law);
}
bool hasFriction(const Sensor& sensor) {
  return sensor.skin.friction.tangential_stiffness > 0;
}
bool isLuGre(const Sensor& sensor) {
  return std::holds_alternative<LuGre>(sensor.skin.law);
}

bool hasNoise(const Readout& readout) {
  return readout.noise > 0 || readout.bias > 0 || readout.random_walk > 0;
}
bool hasLag(const Readout& readout) {
  return !readout.hysteresis_strength.empty() || !readout.creep.empty() || readout.low_pass_time > 0 || readout.delay > 0;
}

StageWork pointDepths(const FrameCounts& counts) {
  StageWork work{.stage = "depths"};
  if (counts.triangles == 0) {
    work.operations = kCylinderSample * counts.samples;
    return work;
  }
  const double quads = counts.triangles / 2, boxes = quads / kQuadsOfBox * (1 + 1 / kBoxesOfGroup);
  work.operations =
      kBox * boxes + kQuadFetch * quads + kQuadSetup * counts.triangles_over_samples / 2 + kQuadSample * counts.touched_samples;
  return work;
}

// What area sampling takes more than points.
StageWork areaDepths(const Sensor& sensor, const FrameCounts& counts) {
  const bool varies = hasFriction(sensor) || isLuGre(sensor) || isLayer(sensor);
  StageWork work{.stage = "area sampling"};
  if (counts.triangles == 0) {
    const double inside = counts.touched_samples - counts.edge_samples;
    work.operations = (kTubeCell - kCylinderSample) * counts.samples + kInsideCell * inside + kEdgeCell * counts.edge_samples;
    if (varies) work.operations += kVariationInside * inside + kVariationEdge * counts.edge_samples;
  } else {
    work.operations = kQuadInCells * counts.triangles / 2 + kFacet * counts.triangles + kFacetCell * counts.facet_samples +
                      (kTakeSums - kQuadSample) * counts.touched_samples - kQuadSetup * counts.triangles_over_samples / 2;
    if (varies) work.operations += kVariationFacet * counts.facet_samples;
  }
  work.operations += (kGiveCell + (varies ? kVariationCell : 0)) * counts.touched_samples;
  return work;
}

StageWork shearWork(const Sensor& sensor, const FrameCounts& counts) {
  const double samples = isLayer(sensor) ? counts.pressed_nodes : counts.touched_samples;
  const bool is_lugre = isLuGre(sensor);
  return {.stage = is_lugre ? "lugre" : "friction",
          .bytes = kMotionBytes + kRectangleBytes + 2 * kInOut * samples,
          .operations = (kDraggedSample + (is_lugre ? kBristleSample : kSpringSample)) * samples + kShearTaxel * counts.touched_taxels};
}

StageWork relaxationWork(const Sensor& sensor, const FrameCounts& counts) {
  const auto terms = static_cast<double>(sensor.skin.relaxation.size());
  StageWork work{.stage = "relaxation"};
  if (isLayer(sensor)) {
    work.bytes = kInOut * (1 + terms) * counts.pressed_nodes;
    work.operations = (kLayerRelaxNode + kLayerRelaxTerm * terms) * counts.pressed_nodes + kProduct * counts.products;
  } else {
    work.bytes = kRectangleBytes + kInOut * (1 + terms) * counts.touched_samples;
    work.operations = (kRelaxSample + kRelaxTerm * terms) * counts.touched_samples;
  }
  return work;
}

StageWork lagWork(const Readout& readout, const FrameCounts& counts) {
  const auto elements = static_cast<double>(readout.hysteresis_strength.size()), terms = static_cast<double>(readout.creep.size());
  const double low_pass = readout.low_pass_time > 0 ? 1 : 0, ring = readout.delay > 0 ? 1 : 0;
  return {.stage = "time behaviour",
          .bytes = kInOut * (elements + terms + low_pass + ring) * counts.taxels,
          .operations = (kHysteresis * elements + kCreep * terms + kLowPass * low_pass) * counts.taxels};
}

StageWork imperfectionsWork(const Readout& readout, const FrameCounts& counts) {
  double operations = 0;
  if (readout.noise > 0) operations += kGaussian + 1;
  if (readout.bias > 0) operations += kGaussian + 2;
  if (readout.random_walk > 0) operations += kGaussian + 2;
  if (readout.gain_spread > 0) operations += kGaussian + 2 + kExponential;
  if (readout.dead_taxel_probability > 0) operations += kUniform;
  const double taxels = hasNoise(readout) ? counts.taxels : counts.spread_taxels;
  return {.stage = "imperfections", .bytes = readout.random_walk > 0 ? kInOut * taxels : 0, .operations = operations * taxels};
}

// Taxels that the spread brings no force to, where they are read out all the same.
StageWork restOfImage(const FrameCounts& counts) {
  const double taxels = counts.taxels - counts.spread_taxels;
  return {.stage = "other taxels", .bytes = kWord * taxels, .operations = kImageTaxel * taxels};
}

StageWork layerWork(const FrameCounts& counts) {
  return {.stage = "elastic_layer",
          .bytes = kInOut * counts.pressed_nodes + kLayerFeatureBytes,
          .operations =
              (kLayerStart + kLayerIteration * counts.iterations) * counts.samples + kProduct * (1 + counts.iterations) * counts.products};
}

StageWork contactFeaturesWork(int max_regions, const FrameCounts& counts) {
  const double regions = std::min(counts.regions, static_cast<double>(max_regions));
  StageWork work{.stage = "contact features",
                 .bytes = kContactRowBytes * (2 + max_regions) + kWord,
                 .operations = kContactRow * (1 + regions) + kScanTaxel * counts.reporting_taxels};
  // With regions every taxel that reports is scanned once more, and belongs to one of them if they are no more than the rows.
  if (regions > 0) work.operations += kRegionTaxel * counts.reporting_taxels;
  if (regions > 0 && counts.regions <= max_regions) work.operations += kScanTaxel * counts.reporting_taxels;
  return work;
}

StageWork jacobianWork(const Sensor& sensor, const FrameCounts& counts) {
  return {.stage = "tactile Jacobian",
          .bytes = kJacobianBytes,
          .operations = kFluxSample * counts.touched_samples + kFluxRow * sensor.samples_per_taxel * counts.touched_taxels +
                        (kFluxTaxel + kJacobianTaxel) * counts.touched_taxels + kReadingTaxel * counts.reporting_taxels + kJacobianRow};
}

void addLaw(const Sensor& sensor, const FrameCounts& counts, std::vector<StageWork>& stages) {
  const auto* winkler = std::get_if<Winkler>(&sensor.skin.law);
  if (winkler != nullptr && winkler->normal_damping > 0) {
    stages.push_back({.stage = "damping",
                      .bytes = kRectangleBytes + kInOut * counts.touched_samples,
                      .operations = kDampingSample * counts.touched_samples});
  }
  if (std::holds_alternative<MassSpringDamper>(sensor.skin.law)) {
    stages.push_back({.stage = "mass_spring_damper", .bytes = 2 * kInOut * counts.taxels, .operations = kMassTaxel * counts.taxels});
  }
  if (std::holds_alternative<DeformationMask>(sensor.skin.law)) {
    stages.push_back({.stage = "deformation_mask", .bytes = 0, .operations = kMaskTaxel * counts.spread_taxels});
  }
  if (isLayer(sensor)) stages.push_back(layerWork(counts));
}

double seconds(double bytes, double operations, const MachineRates& rates) {
  return std::max(bytes / rates.bandwidth, operations / rates.arithmetic);
}

}  // namespace

std::vector<StageWork> plainFrame(const FrameCounts& counts) {
  const double pose_operations = kBounds + kTransform + 9;  // bounds; rows of the pose in samples
  return {{.stage = "pose", .bytes = kPoseBytes + kInstanceBytes, .operations = pose_operations},
          pointDepths(counts),
          {.stage = "forces", .bytes = 0, .operations = kForceSample * counts.samples + kForceTaxel * counts.touched_taxels},
          {.stage = "image", .bytes = kWord * counts.spread_taxels, .operations = kImageTaxel * counts.spread_taxels},
          {.stage = "features", .bytes = kFeatureBytes, .operations = kFeatures}};
}

std::vector<StageWork> frameWork(const Sensor& sensor, const OutputOptions& outputs, int max_regions, const FrameCounts& counts) {
  std::vector<StageWork> stages = plainFrame(counts);
  const Readout& readout = sensor.readout;
  if (isArea(sensor)) stages.push_back(areaDepths(sensor, counts));
  addLaw(sensor, counts, stages);
  if (hasFriction(sensor) || isLuGre(sensor)) stages.push_back(shearWork(sensor, counts));
  if (!sensor.skin.relaxation.empty()) stages.push_back(relaxationWork(sensor, counts));
  if (hasLag(readout)) stages.push_back(lagWork(readout, counts));
  if (hasNoise(readout) || readout.gain_spread > 0 || readout.dead_taxel_probability > 0) {
    stages.push_back(imperfectionsWork(readout, counts));
  }
  if (hasLag(readout) || hasNoise(readout) || std::holds_alternative<MassSpringDamper>(sensor.skin.law))
    stages.push_back(restOfImage(counts));
  if (outputs.contact_features) stages.push_back(contactFeaturesWork(max_regions, counts));
  if (outputs.tactile_jacobian) stages.push_back(jacobianWork(sensor, counts));
  return stages;
}

nlohmann::ordered_json toJson(const std::vector<StageWork>& stages) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const StageWork& work : stages) json[work.stage] = {{"bytes", work.bytes}, {"operations", work.operations}};
  return json;
}

double limitOf(const std::vector<StageWork>& stages, const MachineRates& rates) {
  double sum = 0;
  for (const StageWork& work : stages) sum += seconds(work.bytes, work.operations, rates);
  return sum;
}

bool isBoundByBytes(const std::vector<StageWork>& stages, const MachineRates& rates) {
  double bytes = 0, operations = 0;
  for (const StageWork& work : stages) bytes += work.bytes, operations += work.operations;
  return bytes / rates.bandwidth > operations / rates.arithmetic;
}

}  // namespace taxelsim::bench
