#include "simulation/feature_table.h"

#include <array>
#include <initializer_list>

#include "shared/features.h"

namespace taxelsim {
namespace {

#define TAXELSIM_FIELD(view, name, offset, width, unit, frame, recorded, text) \
  FeatureField<view> {                                                         \
#name, offset, width, unit, frame, recorded, text, &view::name             \
  }
#define TAXELSIM_FEATURE(constant, ...) TAXELSIM_FIELD(FeatureView, __VA_ARGS__),
#define TAXELSIM_READOUT(constant, ...) TAXELSIM_FIELD(FrameView, __VA_ARGS__),
#define TAXELSIM_TRUTH(constant, ...) TAXELSIM_FIELD(GroundTruthView, __VA_ARGS__),
#define TAXELSIM_CONTACT(constant, ...) TAXELSIM_FIELD(ContactFeatureView, __VA_ARGS__),
#define TAXELSIM_JACOBIAN(constant, ...) TAXELSIM_FIELD(TactileJacobianView, __VA_ARGS__),
#define TAXELSIM_WRENCH(constant, ...) TAXELSIM_FIELD(CleanTactileJacobianView, __VA_ARGS__),

constexpr std::array kImageFeatures{TAXELSIM_IMAGE_FEATURES(TAXELSIM_FEATURE)};
constexpr std::array kReadoutFeatures{TAXELSIM_READOUT_FEATURES(TAXELSIM_READOUT)};
constexpr std::array kTruthFeatures{TAXELSIM_TRUTH_FEATURES(TAXELSIM_TRUTH)};
constexpr std::array kContactFeatures{TAXELSIM_CONTACT_FEATURES(TAXELSIM_CONTACT)};
constexpr std::array kRegionFeatures{TAXELSIM_REGION_FEATURES(TAXELSIM_CONTACT)};
constexpr std::array kJacobianFeatures{TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_JACOBIAN)};
constexpr std::array kWrenchJacobian{TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_WRENCH)};

// Whether the blocks of a table follow each other without gaps, from component `start` to before `end`.
template <typename Table>
constexpr bool fills(const Table& table, std::size_t start, std::size_t end) {
  for (const auto& field : table) {
    if (field.offset != start) return false;
    start += field.width;
  }
  return start == end;
}

static_assert(fills(kImageFeatures, 0, layout::kNumImageFeatures));
static_assert(fills(kReadoutFeatures, 2 * layout::kNumImageFeatures, layout::kFeatureContactWrench));
static_assert(fills(kTruthFeatures, layout::kFeatureContactWrench, layout::kNumFeatures));
static_assert(fills(kContactFeatures, layout::kNumImageFeatures, layout::kNumContactFeatures));
static_assert(fills(kRegionFeatures, layout::kNumContactFeatures, layout::kNumContactFeatures + 1));
static_assert(fills(kJacobianFeatures, 0, layout::kNumJacobian));
static_assert(fills(kWrenchJacobian, layout::kNumJacobian, layout::kNumJacobian + layout::kNumWrenchJacobian));

// A view has no field of features that the tables lack. The sizes: the spans of the tables, then whatever else the view has.
constexpr std::size_t spans(std::size_t count) {
  return count * sizeof(std::span<const float>);
}
struct RowCounts {
  int num_rows, num_patches;
};
static_assert(sizeof(FeatureView) == spans(kImageFeatures.size()));
static_assert(sizeof(ContactFeatureView) ==
              sizeof(FeatureView) + sizeof(RowCounts) + spans(kContactFeatures.size() + kRegionFeatures.size()));
static_assert(sizeof(TactileJacobianView) == sizeof(RowCounts) + spans(kJacobianFeatures.size()));
static_assert(sizeof(CleanTactileJacobianView) == sizeof(TactileJacobianView) + spans(kWrenchJacobian.size()));
constexpr std::size_t kTaxelArrays = 4;  // tactile_normal_force, tactile_shear_force, penetration_depth, taxel_jacobian
static_assert(sizeof(GroundTruthView) == sizeof(FeatureView) + spans(kTaxelArrays + kTruthFeatures.size()) + sizeof(ContactFeatureView) +
                                             sizeof(CleanTactileJacobianView));

}  // namespace

std::span<const FeatureField<FeatureView>> imageFeatures() {
  return kImageFeatures;
}
std::span<const FeatureField<FrameView>> readoutFeatures() {
  return kReadoutFeatures;
}
std::span<const FeatureField<GroundTruthView>> truthFeatures() {
  return kTruthFeatures;
}
std::span<const FeatureField<ContactFeatureView>> contactFeatures() {
  return kContactFeatures;
}
std::span<const FeatureField<ContactFeatureView>> regionFeatures() {
  return kRegionFeatures;
}
std::span<const FeatureField<TactileJacobianView>> jacobianFeatures() {
  return kJacobianFeatures;
}
std::span<const FeatureField<CleanTactileJacobianView>> wrenchJacobian() {
  return kWrenchJacobian;
}

}  // namespace taxelsim
