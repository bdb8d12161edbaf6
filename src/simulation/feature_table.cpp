#include "simulation/feature_table.h"

#include <array>
#include <initializer_list>

#include "shared/features.h"

namespace taxelsim {
namespace {

#define TAXELSIM_FIELD(view, constant, name, offset, width, type, unit, frame, recorded, text) \
  FeatureField<view> {                                                                         \
#name, layout::constant, width, unit, frame, recorded, text, &view::name                   \
  }
#define TAXELSIM_FEATURE(...) TAXELSIM_FIELD(FeatureView, __VA_ARGS__),
#define TAXELSIM_READOUT(...) TAXELSIM_FIELD(FrameView, __VA_ARGS__),
#define TAXELSIM_TRUTH(...) TAXELSIM_FIELD(GroundTruthView, __VA_ARGS__),
#define TAXELSIM_CONTACT(...) TAXELSIM_FIELD(ContactFeatureView, __VA_ARGS__),
#define TAXELSIM_JACOBIAN(...) TAXELSIM_FIELD(TactileJacobianView, __VA_ARGS__),
#define TAXELSIM_WRENCH(...) TAXELSIM_FIELD(CleanTactileJacobianView, __VA_ARGS__),

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
static_assert(fills(kReadoutFeatures, layout::kFirstReadoutFeature, layout::kFirstTruthFeature));
static_assert(fills(kTruthFeatures, layout::kFirstTruthFeature, layout::kNumFeatures));
static_assert(fills(kContactFeatures, layout::kNumImageFeatures, layout::kNumContactFeatures));
static_assert(fills(kJacobianFeatures, 0, layout::kNumJacobian));

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
