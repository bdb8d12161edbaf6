// The features of a frame at run time, from the tables of taxelsim/feature_table.h: for data-set columns, JSON, text and documentation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "taxelsim/simulator.h"

namespace taxelsim {

// Values of one feature for all rows of a batch, (num_rows x width).
using FeatureValues =
    std::variant<std::span<const float>, std::span<const std::int32_t>, std::span<const bool>, std::span<const ContactType>>;

// The field of a view that has them.
template <typename View>
using FeatureMember = std::variant<std::span<const float> View::*, std::span<const std::int32_t> View::*, std::span<const bool> View::*,
                                   std::span<const ContactType> View::*>;

// One row of a table; taxelsim/feature_table.h says what the entries mean.
template <typename View>
struct FeatureField {
  std::string_view name;
  std::size_t offset = 0;  // components
  std::size_t width = 1;   // components
  std::string_view unit, frame, recorded, text;
  FeatureMember<View> member;

  FeatureValues values(const View& view) const {
    return std::visit([&](auto field) { return FeatureValues(view.*field); }, member);
  }
  // Description of the column; `forces`: source of the feature.
  std::string description(std::string_view forces) const {
    std::string result(text);
    if (const std::size_t place = result.find("{}"); place != std::string::npos) result.replace(place, 2, forces);
    return result;
  }
};

std::span<const FeatureField<FeatureView>> imageFeatures();
std::span<const FeatureField<FrameView>> readoutFeatures();
std::span<const FeatureField<GroundTruthView>> truthFeatures();
std::span<const FeatureField<ContactFeatureView>> contactFeatures();  // of a row, in addition to the image features
std::span<const FeatureField<ContactFeatureView>> regionFeatures();   // one value per instance
std::span<const FeatureField<TactileJacobianView>> jacobianFeatures();
std::span<const FeatureField<CleanTactileJacobianView>> wrenchJacobian();  // one matrix per instance

}  // namespace taxelsim
