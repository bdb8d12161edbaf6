// Interfaces of passes: the lists in shaders/passes/ as C++ types against the compiled shaders, and what the types refuse.
#include <spirv_cross/spirv.h>

#include "contact.spv.h"
#include "contact_features.spv.h"
#include "contact_regions.spv.h"
#include "contacts.spv.h"
#include "deformation_mask.spv.h"
#include "elastic_layer.spv.h"
#include "find_candidates.spv.h"
#include "force_gradient.spv.h"
#include "gpu/bindings.h"
#include "gpu/pass_kernel.h"
#include "gpu/reflection.h"
#include "heights.spv.h"
#include "image.spv.h"
#include "keep_candidates.spv.h"
#include "load.spv.h"
#include "mask_jacobian.spv.h"
#include "mass_spring_damper.spv.h"
#include "rescale_jacobian.spv.h"
#include "simulation/passes/interfaces.h"
#include "spread_jacobian.spv.h"
#include "support/test.h"
#include "tactile_jacobian.spv.h"
#include "taxel_jacobian.spv.h"
#include "three_axis.spv.h"

namespace taxelsim {
namespace {

using ::testing::HasSubstr;

// ---- what cannot compile ----

using BoolConstant = gpu::SpecConstant<0, bool>;
using UintConstant = gpu::SpecConstant<1, std::uint32_t>;
using FloatConstant = gpu::SpecConstant<2, float>;
static_assert(std::is_constructible_v<BoolConstant, bool> && !std::is_constructible_v<BoolConstant, int>);
static_assert(!std::is_constructible_v<BoolConstant, float> && !std::is_constructible_v<BoolConstant, const void*>);
static_assert(std::is_constructible_v<UintConstant, int> && std::is_constructible_v<UintConstant, std::size_t>);
static_assert(!std::is_constructible_v<UintConstant, bool> && !std::is_constructible_v<UintConstant, double>);
static_assert(std::is_constructible_v<FloatConstant, double> && std::is_constructible_v<FloatConstant, float>);
static_assert(!std::is_constructible_v<FloatConstant, bool> && !std::is_constructible_v<FloatConstant, std::uint32_t>);

// A constant takes no other constant's place, and none may be left out.
static_assert(!std::is_assignable_v<gpu::SpecConstant<2, float>&, gpu::SpecConstant<3, float>>);
static_assert(!std::is_default_constructible_v<TaxelJacobianInterface>);
template <typename Interface>
concept TakesAFloatForABool = requires {
  Interface{.SCALED = 1.0f};
};
template <typename Interface>
concept TakesABool = requires {
  Interface{.SCALED = false};
};
template <typename Interface>
concept TakesTooFew = requires {
  Interface{};
};
static_assert(TakesABool<TaxelJacobianInterface> && !TakesAFloatForABool<TaxelJacobianInterface> && !TakesTooFew<TaxelJacobianInterface>);

// A kernel is bound by the blocks of its own pass, each of a type of its own.
static_assert(!std::is_convertible_v<gpu::PassKernel<LoadInterface>, gpu::PassKernel<ImageInterface>>);
static_assert(std::is_same_v<gpu::BlockAt<LoadInterface, 3>, block::Loads> && !std::is_same_v<block::Loads, block::TileResults>);
static_assert(std::is_same_v<block::Loads::Element, layout::LoadRecord>);

// ---- the lists against the shaders ----

template <typename Interface, std::uint32_t... kBindings>
std::map<std::uint32_t, std::string> blocksOf(std::integer_sequence<std::uint32_t, kBindings...>) {
  return {{kBindings, gpu::BlockAt<Interface, kBindings>::kName}...};
}

bool isFloatArithmetic(std::uint32_t operation) {
  return operation == SpvOpFNegate || operation == SpvOpFAdd || operation == SpvOpFSub || operation == SpvOpFMul ||
         operation == SpvOpFDiv || operation == SpvOpFMod || (operation >= SpvOpVectorTimesScalar && operation <= SpvOpDot);
}

// A driver may rearrange or fuse what is not marked.
void expectExact(std::span<const std::uint32_t> spirv) {
  constexpr std::size_t kHeaderWords = 5;
  std::set<std::uint32_t> marked, results;
  for (std::size_t at = kHeaderWords; at < spirv.size(); at += spirv[at] >> SpvWordCountShift) {
    const std::uint32_t operation = spirv[at] & SpvOpCodeMask;
    if (operation == SpvOpDecorate && spirv[at + 2] == SpvDecorationNoContraction) marked.insert(spirv[at + 1]);
    if (isFloatArithmetic(operation)) results.insert(spirv[at + 2]);
  }
  EXPECT_FALSE(results.empty());
  EXPECT_EQ(marked, results);
}

template <typename Interface>
void expectMatches(std::span<const std::uint32_t> spirv, const char* name) {
  SCOPED_TRACE(name);
  constexpr std::uint32_t kNumCommon = gpu::countConstantsFrom<CommonConstants, 0>();
  std::vector<std::uint32_t> ids(kNumCommon + gpu::countConstantsFrom<Interface, kNumCommon>());
  std::iota(ids.begin(), ids.end(), 0u);
  const gpu::Reflection reflection = gpu::reflect(spirv);
  EXPECT_EQ(reflection.constants, ids);
  EXPECT_EQ(reflection.buffers, blocksOf<Interface>(std::make_integer_sequence<std::uint32_t, gpu::countBuffers<Interface>()>()));
  expectExact(spirv);
}

// Ids and bindings are contiguous, and no list has more or fewer than its shader, of which all arithmetic is exact.
TEST(PassInterfaces, MatchTheShaders) {
  expectMatches<ContactInterface>(k_contact_spirv, "contact");
  expectMatches<HeightsInterface>(k_heights_spirv, "heights");
  expectMatches<KeepCandidatesInterface>(k_keep_candidates_spirv, "keep_candidates");
  expectMatches<FindCandidatesInterface>(k_find_candidates_spirv, "find_candidates");
  expectMatches<LoadInterface>(k_load_spirv, "load");
  expectMatches<ElasticLayerInterface>(k_elastic_layer_spirv, "elastic_layer");
  expectMatches<TaxelLawInterface>(k_mass_spring_damper_spirv, "taxel_law");
  expectMatches<ContactsInterface>(k_contacts_spirv, "contacts");
  expectMatches<DeformationMaskInterface>(k_deformation_mask_spirv, "deformation_mask");
  expectMatches<ImageInterface>(k_image_spirv, "image");
  expectMatches<ThreeAxisInterface>(k_three_axis_spirv, "three_axis");
  expectMatches<ContactRegionsInterface>(k_contact_regions_spirv, "contact_regions");
  expectMatches<ContactFeaturesInterface>(k_contact_features_spirv, "contact_features");
  expectMatches<TaxelJacobianInterface>(k_taxel_jacobian_spirv, "taxel_jacobian");
  expectMatches<MaskJacobianInterface>(k_mask_jacobian_spirv, "mask_jacobian");
  expectMatches<RescaleJacobianInterface>(k_rescale_jacobian_spirv, "rescale_jacobian");
  expectMatches<SpreadJacobianInterface>(k_spread_jacobian_spirv, "spread_jacobian");
  expectMatches<TactileJacobianInterface>(k_tactile_jacobian_spirv, "tactile_jacobian");
  expectMatches<ForceGradientInterface>(k_force_gradient_spirv, "force_gradient");
}

TEST(PassInterfaces, ConstantsKeepIdAndBits) {
  const auto list =
      gpu::constantsOf<11>(TaxelLawInterface{.SCALED = true, .LAW_0 = 0.5, .LAW_1 = 2.0f, .SHEAR = false, .FRICTION_COEFFICIENT = -1.0});
  const std::array<std::uint32_t, 5> bits{1, 0x3F000000u, 0x40000000u, 0, 0xBF800000u};
  ASSERT_EQ(list.size(), bits.size());
  for (std::uint32_t k = 0; k < bits.size(); ++k) {
    EXPECT_EQ(list[k].id, 11 + k);
    EXPECT_EQ(list[k].value, bits[k]) << k;
  }
}

TEST(PassInterfaces, RejectIntegersOutOfRange) {
  EXPECT_THROW(SpreadJacobianInterface{.NUM_ENTRIES = -1}, std::logic_error);
  EXPECT_THROW(SpreadJacobianInterface{.NUM_ENTRIES = std::uint64_t{1} << 32}, std::logic_error);
}

TEST(Bindings, RejectBlocksWithoutABuffer) {
  const gpu::Buffer buffer, other;
  gpu::Bindings bindings;
  bindings.bind<block::Instances>(buffer);
  bindings.bind<block::Step>(buffer);
  bindings.bind<block::Loads>(buffer);
  try {
    bindings.of<LoadInterface>();
    FAIL() << "nothing thrown";
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("TileResults"));
  }
  bindings.bind<block::Windows>(other);
  bindings.redirect<block::TileResults, block::Windows>();
  EXPECT_EQ(bindings.of<LoadInterface>(), (std::array<const gpu::Buffer*, 4>{&buffer, &buffer, &other, &buffer}));
}

}  // namespace
}  // namespace taxelsim
