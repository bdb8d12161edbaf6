// Specialization constants and buffers of every pass, from the lists in shaders/passes/ that the shaders read too; gpu/pass_interface.h
// says how they are used. Constants have the names and types that they have in the shader; values that both languages need are members.
#pragma once

#include "gpu/pass_interface.h"
#include "simulation/passes/blocks.h"

namespace taxelsim {

// NOLINTBEGIN(bugprone-macro-parentheses): arguments are types and names
#define CONSTANT(id, type, NAME)    \
  gpu::SpecConstant<id, type> NAME; \
  static gpu::SpecConstant<id, type> constantAt(gpu::At<id>);
#define VALUE(kName, value) static constexpr uint kName = value;
#define BUFFER(binding, access, Block) static block::Block blockAt(gpu::At<binding>);
#define UNIFORM(binding, Block) static block::Block blockAt(gpu::At<binding>);
#define TEXELS(binding, Block) static block::Block blockAt(gpu::At<binding>);
#define COHERENT_TEXELS(binding, Block) static block::Block blockAt(gpu::At<binding>);
// NOLINTEND(bugprone-macro-parentheses)

using layout::uint;

struct CommonConstants {
#include "passes/common.h"
};

struct DepthInterface {
#include "passes/depth.h"
};

// A pass that computes stage 1: its list goes on from that of DepthInterface.
#define TAXELSIM_AFTER_DEPTH                                               \
  DepthInterface depth;                                                    \
  template <typename Id>                                                   \
  static auto constantAt(Id id)->decltype(DepthInterface::constantAt(id)); \
  template <typename Id>                                                   \
  static auto blockAt(Id id)->decltype(DepthInterface::blockAt(id));

struct ContactInterface {
  TAXELSIM_AFTER_DEPTH
#include "passes/contact.h"
};

struct HeightsInterface {
  TAXELSIM_AFTER_DEPTH
#include "passes/heights.h"
};
#undef TAXELSIM_AFTER_DEPTH

struct KeepCandidatesInterface {
#include "passes/keep_candidates.h"
};

struct FindCandidatesInterface {
#include "passes/find_candidates.h"
};

struct LoadInterface {
#include "passes/load.h"
};

struct ElasticLayerInterface {
#include "passes/elastic_layer.h"
};

struct TaxelLawInterface {
#include "passes/taxel_law.h"
};

struct ContactsInterface {
#include "passes/contacts.h"
};

struct DeformationMaskInterface {
#include "passes/deformation_mask.h"
};

struct ImageInterface {
#include "passes/image.h"
};

struct ThreeAxisInterface {
#include "passes/three_axis.h"
};

struct IntegerFeaturesInterface {
#include "passes/integer_features.h"
};

struct ContactRegionsInterface {
#include "passes/contact_regions.h"
};

struct ContactFeaturesInterface {
#include "passes/contact_features.h"
};

struct TaxelJacobianInterface {
#include "passes/taxel_jacobian.h"
};

struct WrenchJacobianInterface {
#include "passes/wrench_jacobian.h"
};

struct MaskJacobianInterface {
#include "passes/mask_jacobian.h"
};

struct RescaleJacobianInterface {
#include "passes/rescale_jacobian.h"
};

struct SpreadJacobianInterface {
#include "passes/spread_jacobian.h"
};

struct TactileJacobianInterface {
#include "passes/tactile_jacobian.h"
};

struct ForceGradientInterface {
#include "passes/force_gradient.h"
};

struct PlaceInterface {
#include "passes/place.h"
};

struct ServoInterface {
#include "passes/servo.h"
};

#undef CONSTANT
#undef VALUE
#undef BUFFER
#undef TEXELS
#undef COHERENT_TEXELS
#undef UNIFORM

}  // namespace taxelsim
