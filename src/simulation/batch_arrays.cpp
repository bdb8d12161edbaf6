#include "simulation/batch_arrays.h"

#include "shared/elastic_layer.h"
#include "shared/features.h"
#include "simulation/integer_features.h"
#include "simulation/passes/interfaces.h"

namespace taxelsim {
namespace {

using Shape = const BatchShape&;
using Count = std::uint64_t (*)(Shape);
using IsRead = bool (*)(const BatchOptions&);

template <typename Block>
constexpr BatchArray input(const char* name, Count count) {
  return {Block::kIndex, name, sizeof(typename Block::Element), count, gpu::Domain::kUpload};
}

template <typename Block>
constexpr BatchArray internal(const char* name, Count count) {
  return {Block::kIndex, name, sizeof(typename Block::Element), count, gpu::Domain::kDevice};
}

template <typename Block>
constexpr BatchArray output(const char* name, Count count, IsRead is_read) {
  return {Block::kIndex, name, sizeof(typename Block::Element), count, gpu::Domain::kDevice, is_read};
}

// An array of frames.
template <typename Block>
constexpr BatchArray shown(const char* name, Count count, IsRead is_read, Export exports = Export::kOnly) {
  BatchArray array = output<Block>(name, count, is_read);
  array.exports = exports;
  return array;
}

// An array that another interface writes.
template <typename Block>
constexpr BatchArray exportedInput(const char* name, Count count) {
  BatchArray array = internal<Block>(name, count);
  array.exports = Export::kInput;
  return array;
}

constexpr BatchArray perBatch(BatchArray array) {
  array.per_instance = false;
  return array;
}

constexpr BatchArray twice(BatchArray array) {
  array.is_double = true;
  return array;
}

constexpr BatchArray readAfter(unsigned read_after, BatchArray array) {
  array.read_after = read_after;
  return array;
}

constexpr bool always(const BatchOptions&) {
  return true;
}

std::uint64_t countIf(bool condition, std::uint64_t count) {
  return condition ? count : 0;
}

std::uint64_t taxels(Shape s) {
  return s.model.num_taxels;
}
std::uint64_t tiles(Shape s) {
  return s.model.packed.tiles.size();
}
std::uint64_t nodes(Shape s) {
  return static_cast<std::uint64_t>(numTaxels(s.model.contact_sensor));
}
std::uint64_t slots(Shape s) {
  return static_cast<std::uint64_t>(s.options.num_slots);
}

// Strain and overstresses of a sample of a skin that relaxes.
std::uint64_t relaxationStates(Shape s) {
  return s.model.relaxes() ? 1 + s.model.sensor.skin.relaxation.size() : 0;
}

// Elements of four words: a sample's states lie in its group of four samples of a row, shaders/skin/sample_states.glsl.
std::uint64_t contactStates(Shape s) {
  const std::uint64_t states = s.model.numSampleStates();
  if (s.takesContacts() || states == 0) return 0;
  const auto side = static_cast<std::uint64_t>(s.model.contact_sensor.samples_per_taxel);
  return tiles(s) * (layout::kStateHeader + s.model.contact_packed.max_tile_samples / side * ((side + 3) / 4) * states);
}

std::uint64_t layerFrictionStates(Shape s) {
  return countIf(s.hasFriction() && s.hasLayer(), tiles(s) * layout::kFrictionHeader + nodes(s));
}

// Pairs of words of all arrays over strips of nodes.
std::uint64_t layerPairs(Shape s) {
  if (!s.hasLayer()) return 0;
  const std::uint64_t padded_nodes = s.model.layer->influence.size() / 2;
  const std::uint64_t compliances = !s.model.area() ? 0 : s.model.relaxes() ? 2 : 1;
  return (layout::kNumLayerArrays + relaxationStates(s) + compliances) * padded_nodes / 2;
}

std::uint64_t numContactFeatures(Shape s) {
  return 1 + std::uint64_t{layout::kNumContactFeatures} * numContactRows(s.model.packed_contact, s.options.max_regions);
}
// Integer features of an instance, at most.
std::uint64_t numIntegerFeatures(Shape s) {
  const OutputOptions& outputs = s.options.outputs;
  const std::uint64_t contacts = (outputs.contact_features ? 1 : 0) + (outputs.clean_contact_features ? 1 : 0);
  return kMaxIntegerRows * (1 + contacts * numContactRows(s.model.packed_contact, s.options.max_regions));
}
std::uint64_t numJacobianFeatures(Shape s) {
  return std::uint64_t{layout::kNumJacobian} * numContactRows(s.model.packed_contact, 0);
}

// shaders/features/taxel_words.glsl.
std::uint64_t paddedTaxels(Shape s) {
  return (taxels(s) + 3) / 4 * 4;
}

std::uint64_t gradientTaxels(Shape s) {
  return countIf(s.options.outputs.vjp, taxels(s));
}

std::uint64_t loopValues(Shape s, std::uint64_t count) {
  return countIf(s.options.loop.has_value(), count);
}
std::uint64_t loopJoints(const BatchOptions& options) {
  return options.loop ? static_cast<std::uint64_t>(options.loop->numJoints()) : 0;
}
std::uint64_t loopStates(Shape s) {
  if (!s.options.loop) return 0;
  const auto delay = static_cast<std::uint64_t>(s.options.loop->robot ? s.options.loop->robot->robot.drive.delay : 0);
  return ServoInterface::kNumLoopState + loopJoints(s.options) * (ServoInterface::kNumJointState + delay);
}
std::uint64_t jointOutputs(Shape s) {
  return s.options.loop && s.options.loop->outputs.joints ? loopJoints(s.options) : 0;
}
bool readsJoints(const BatchOptions& o) {
  return loopJoints(o) > 0 && o.loop->outputs.joints;
}
template <bool LoopOutputs::*kOutput>
bool isLoopOutput(const BatchOptions& o) {
  return o.loop && (*o.loop).outputs.*kOutput;
}

constexpr BatchArray kArrays[] = {
    input<block::Poses>("poses", [](Shape s) { return countIf(!s.takesContacts(), slots(s)); }),
    input<block::Motions>("motions", [](Shape s) { return countIf(s.hasFriction(), slots(s)); }),
    twice(input<block::Instances>("instances", [](Shape) { return std::uint64_t{1}; })),
    input<block::Loads>("loads", [](Shape) { return std::uint64_t{1}; }),
    input<block::Contacts>("contacts", [](Shape s) { return static_cast<std::uint64_t>(s.options.max_contacts); }),
    input<block::NumContacts>("num_contacts", [](Shape s) { return countIf(s.takesContacts(), 1); }),
    twice(perBatch(input<block::Step>("step", [](Shape) { return std::uint64_t{1}; }))),
    input<block::Cotangents>("cotangents", gradientTaxels),
    input<block::ForceCotangents>("cotangents of forces", gradientTaxels),
    exportedInput<block::InputPositions>("input positions", [](Shape s) { return 3 * s.contactInputs(); }),
    exportedInput<block::InputForces>("input forces", [](Shape s) { return s.contactInputs(); }),
    exportedInput<block::InputCounts>("input counts", [](Shape s) { return countIf(s.contactInputs() > 0, 1); }),
    exportedInput<block::InputIds>("input ids", [](Shape s) { return countIf(s.takesObjects(), slots(s)); }),
    exportedInput<block::InputPoses>("input poses", [](Shape s) { return countIf(s.takesObjects(), 7 * slots(s)); }),
    exportedInput<block::InputLoads>("input loads", [](Shape s) { return countIf(s.takesObjects(), 1); }),
    perBatch(input<block::Servos>("servos", [](Shape s) { return s.options.loop ? std::uint64_t{s.options.loop->servos.size()} : 0; })),
    perBatch(input<block::Loop>("loop", [](Shape s) { return loopValues(s, 1); })),
    perBatch(input<block::Robot>("robot of loops", [](Shape s) { return countIf(loopJoints(s.options) > 0, 1); })),
    input<block::LoopStarts>("starts of loops", [](Shape s) { return loopValues(s, 1); }),

    internal<block::PlacedPoses>(
        "placed poses", [](Shape s) { return countIf(s.takesObjects() && s.hasFriction(), PlaceInterface::kPlacedNumbers * slots(s)); }),
    internal<block::LoopState>("state of loops", loopStates),
    internal<block::Candidates>("candidates", [](Shape s) { return countIf(s.keeps_candidates, 1); }),
    internal<block::CandidateQuads>("candidate quads", [](Shape s) { return countIf(s.keeps_candidates, layout::kMaxCandidates); }),
    internal<block::WorkInstances>("work lists",
                                   [](Shape s) {
                                     return countIf(s.keeps_candidates || s.model.leaves_tiles, layout::kNumLists) +
                                            countIf(s.model.leaves_tiles, tiles(s));
                                   }),
    internal<block::State>("contact state", contactStates),
    internal<block::LawState>(
        "law state",
        [](Shape s) { return countIf(!s.model.law.taxel_passes.empty() || (s.model.hasMask() && s.outputsJacobian()), taxels(s)); }),
    internal<block::FrictionState>("friction state", layerFrictionStates),
    internal<block::ContactNormal>("contact_normal", taxels),
    internal<block::MaskedNormal>("masked_normal", [](Shape s) { return countIf(s.model.hasMask() && !s.takesContacts(), taxels(s)); }),
    internal<block::ContactShear>("contact_shear", [](Shape s) { return countIf(s.outputsShear(), 2 * taxels(s)); }),
    internal<block::TaxelStates>("taxel states", [](Shape s) { return s.model.packed.num_states * taxels(s); }),
    internal<block::TileResults>("tile_results", tiles),
    internal<block::ImageWindows>("image windows",
                                  [](Shape s) { return countIf(s.model.packed.one_grid && s.model.sensor.frame_rate == 0, 1); }),
    internal<block::Heights>("heights",
                             [](Shape s) { return countIf(s.hasLayer(), (nodes(s) + 7) / 4 * 4); }),  // read in fours, one beyond the end
    internal<block::NodeCells>("cells of nodes",
                               [](Shape s) { return countIf(s.hasLayer() && s.model.area(), layout::kNodeCellWords * nodes(s)); }),
    internal<block::Windows>("windows", [](Shape s) { return countIf(s.hasLayer(), s.model.contact_packed.tiles.size()); }),
    internal<block::Layer>("layer", layerPairs),

    internal<block::AxisPlays>("hysteresis of axes", [](Shape s) { return countIf(s.options.outputs.taxel_counts, 3 * taxels(s)); }),
    internal<block::Forces>("forces", [](Shape s) { return countIf(s.outputsContactFeatures(), paddedTaxels(s)); }),
    internal<block::TaxelRegions>("taxel regions", [](Shape s) { return countIf(s.outputsContactFeatures(), paddedTaxels(s)); }),
    internal<block::RegionSums>("region sums",
                                [](Shape s) { return countIf(s.outputsContactFeatures() && s.options.max_regions > 0, paddedTaxels(s)); }),
    internal<block::Regions>(
        "regions", [](Shape s) { return countIf(s.outputsContactFeatures(), static_cast<std::uint64_t>(s.options.max_regions)); }),

    internal<block::ContactCells>("contact cells", [](Shape s) { return countIf(s.outputsJacobian() && !s.model.layer, taxels(s)); }),
    internal<block::TileChanges>("tile changes",
                                 [](Shape s) {
                                   return countIf(s.options.outputs.clean_tactile_jacobian && !s.model.layer,
                                                  tiles(s) * s.model.packed.contact_lanes * layout::kTileChanges);
                                 }),
    internal<block::TaxelJacobian>("taxel Jacobian", [](Shape s) { return countIf(s.outputsJacobian(), 6 * taxels(s)); }),
    internal<block::MaskedJacobian>("masked Jacobian",
                                    [](Shape s) { return countIf(s.outputsJacobian() && s.model.hasMask(), 6 * taxels(s)); }),
    internal<block::WrenchJacobian>("wrench Jacobian",
                                    [](Shape s) { return countIf(s.outputsJacobian(), tiles(s) * layout::kNumWrenchJacobian); }),

    shown<block::ContactDepth>(
        "penetration_depth", [](Shape s) { return countIf(s.options.outputs.penetration_depth, taxels(s)); },
        [](const BatchOptions& o) { return o.outputs.penetration_depth; }),
    shown<block::Image>("tactile_image", taxels, [](const BatchOptions& o) { return !o.loop || o.loop->outputs.tactile_image; }),
    shown<block::SpreadNormal>("tactile_normal_force", taxels, [](const BatchOptions& o) { return o.outputs.tactile_normal_force; }),
    shown<block::SpreadShear>(
        "tactile_shear_force",
        [](Shape s) { return countIf(s.options.outputs.tactile_shear_force || s.options.outputs.taxel_counts, 2 * taxels(s)); },
        [](const BatchOptions& o) { return o.outputs.tactile_shear_force; }),
    shown<block::TaxelCounts>(
        "taxel_counts", [](Shape s) { return countIf(s.options.outputs.taxel_counts, 3 * taxels(s)); },
        [](const BatchOptions& o) { return o.outputs.taxel_counts; }),
    shown<block::Features>(
        "features", [](Shape) { return std::uint64_t{layout::kNumFeatures}; }, always, Export::kToo),
    shown<block::ContactFeatures>(
        "contact_features", [](Shape s) { return countIf(s.options.outputs.contact_features, numContactFeatures(s)); },
        [](const BatchOptions& o) { return o.outputs.contact_features; }),
    shown<block::CleanContactFeatures>(
        "clean_contact_features", [](Shape s) { return countIf(s.options.outputs.clean_contact_features, numContactFeatures(s)); },
        [](const BatchOptions& o) { return o.outputs.clean_contact_features; }),
    shown<block::TactileJacobian>(
        "tactile_jacobian", [](Shape s) { return countIf(s.options.outputs.tactile_jacobian, numJacobianFeatures(s)); },
        [](const BatchOptions& o) { return o.outputs.tactile_jacobian; }),
    shown<block::CleanTactileJacobian>(
        "clean_tactile_jacobian",
        [](Shape s) { return countIf(s.options.outputs.clean_tactile_jacobian, numJacobianFeatures(s) + layout::kNumWrenchJacobian); },
        [](const BatchOptions& o) { return o.outputs.clean_tactile_jacobian; }),
    shown<block::SpreadJacobian>(
        "taxel_jacobian", [](Shape s) { return countIf(s.options.outputs.taxel_jacobian, 6 * taxels(s)); },
        [](const BatchOptions& o) { return o.outputs.taxel_jacobian; }),
    shown<block::IntegerFeatures>(
        "integer features", [](Shape s) { return countIf(s.options.export_memory, numIntegerFeatures(s)); },
        [](const BatchOptions& o) { return o.export_memory; }),
    perBatch(input<block::IntegerRows>("integer rows", [](Shape s) { return countIf(s.options.export_memory, kMaxIntegerRows); })),
    output<block::ObjectPoses>(
        "poses of objects", [](Shape s) { return countIf(isLoopOutput<&LoopOutputs::object_poses>(s.options), 7); },
        isLoopOutput<&LoopOutputs::object_poses>),
    output<block::SensorPoses>(
        "poses of sensors", [](Shape s) { return countIf(isLoopOutput<&LoopOutputs::sensor_poses>(s.options), 7); },
        isLoopOutput<&LoopOutputs::sensor_poses>),
    output<block::Actions>(
        "actions", [](Shape s) { return countIf(isLoopOutput<&LoopOutputs::actions>(s.options), 6); }, isLoopOutput<&LoopOutputs::actions>),
    output<block::RobotStatuses>(
        "robot status", [](Shape s) { return countIf(isLoopOutput<&LoopOutputs::robot_status>(s.options), 1); },
        isLoopOutput<&LoopOutputs::robot_status>),
    output<block::JointPositions>("joint positions", jointOutputs, readsJoints),
    output<block::JointVelocities>("joint velocities", jointOutputs, readsJoints),
    readAfter(kAfterGradient, output<block::TwistGradient>(
                                  "twist gradient", [](Shape s) { return countIf(s.options.outputs.vjp, 6); }, always)),
    readAfter(kAfterGradient, output<block::GainGradient>("gain gradient", gradientTaxels, always)),
    readAfter(kAfterFrame | kAfterGradient, perBatch(output<block::Problems>(
                                                "problems", [](Shape) { return std::uint64_t{1}; }, always))),
    twice(perBatch(output<block::InputProblems>(
        "input problems", [](Shape) { return std::uint64_t{PlaceInterface::kNumInputProblems}; },
        [](const BatchOptions& o) { return o.export_memory; }))),
    perBatch(output<block::Work>(
        "work", [](Shape) { return std::uint64_t{layout::kNumWorkRows}; }, always)),
};

}  // namespace

std::span<const BatchArray> batchArrays() {
  return kArrays;
}

}  // namespace taxelsim
