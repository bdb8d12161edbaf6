// Modules with their specialization constants set.
#include "gpu/specialization.h"

#include <spirv_cross/spirv.h>

#include "contact.spv.h"
#include "gpu/reflection.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Words = std::vector<std::uint32_t>;

constexpr std::size_t kHeaderWords = 5;
constexpr std::uint32_t kBool = 1, kUint = 2, kVoid = 3, kFunctionType = 4, kSpec = 5, kOne = 6, kTwo = 7, kMain = 8, kEntry = 9;
constexpr std::uint32_t kNot = 10, kHeader = 11, kBody = 12, kLeft = 13, kRight = 14, kMerge = 15, kContinue = 16, kPhi = 17, kSum = 18;
constexpr std::uint32_t kBound = 19;

void add(Words& words, SpvOp op, std::initializer_list<std::uint32_t> operands) {
  words.push_back(static_cast<std::uint32_t>(operands.size() + 1) << SpvWordCountShift | op);
  words.insert(words.end(), operands);
}

// Header and globals: kSpec is a bool with constant_id 3, true by default, and kNot its opposite.
Words moduleStart() {
  Words words{SpvMagicNumber, 0x10500, 0, kBound, 0};
  add(words, SpvOpName, {kLeft, 'l'});
  add(words, SpvOpName, {kRight, 'r'});
  add(words, SpvOpDecorate, {kSpec, SpvDecorationSpecId, 3});
  add(words, SpvOpTypeBool, {kBool});
  add(words, SpvOpTypeInt, {kUint, 32, 0});
  add(words, SpvOpTypeVoid, {kVoid});
  add(words, SpvOpTypeFunction, {kFunctionType, kVoid});
  add(words, SpvOpSpecConstantTrue, {kBool, kSpec});
  add(words, SpvOpSpecConstantOp, {kBool, kNot, SpvOpLogicalNot, kSpec});
  add(words, SpvOpConstant, {kUint, kOne, 1});
  add(words, SpvOpConstant, {kUint, kTwo, 2});
  add(words, SpvOpFunction, {kVoid, kMain, 0, kFunctionType});
  add(words, SpvOpLabel, {kEntry});
  return words;
}

// phi = !spec ? 1 : 2
Words selection() {
  Words words = moduleStart();
  add(words, SpvOpSelectionMerge, {kMerge, 0});
  add(words, SpvOpBranchConditional, {kNot, kLeft, kRight});
  add(words, SpvOpLabel, {kLeft});
  add(words, SpvOpBranch, {kMerge});
  add(words, SpvOpLabel, {kRight});
  add(words, SpvOpBranch, {kMerge});
  add(words, SpvOpLabel, {kMerge});
  add(words, SpvOpPhi, {kUint, kPhi, kOne, kLeft, kTwo, kRight});
  add(words, SpvOpReturn, {});
  add(words, SpvOpFunctionEnd, {});
  return words;
}

// for (phi = 1;; phi += 2) if (spec) break;
Words loop() {
  Words words = moduleStart();
  add(words, SpvOpBranch, {kHeader});
  add(words, SpvOpLabel, {kHeader});
  add(words, SpvOpPhi, {kUint, kPhi, kOne, kEntry, kSum, kContinue});
  add(words, SpvOpLoopMerge, {kMerge, kContinue, 0});
  add(words, SpvOpBranch, {kBody});
  add(words, SpvOpLabel, {kBody});
  add(words, SpvOpSelectionMerge, {kRight, 0});
  add(words, SpvOpBranchConditional, {kSpec, kLeft, kRight});
  add(words, SpvOpLabel, {kLeft});
  add(words, SpvOpBranch, {kMerge});
  add(words, SpvOpLabel, {kRight});
  add(words, SpvOpBranch, {kContinue});
  add(words, SpvOpLabel, {kContinue});
  add(words, SpvOpIAdd, {kUint, kSum, kPhi, kTwo});
  add(words, SpvOpBranch, {kHeader});
  add(words, SpvOpLabel, {kMerge});
  add(words, SpvOpReturn, {});
  add(words, SpvOpFunctionEnd, {});
  return words;
}

// Operands of all instructions of one kind, one after another.
Words operands(std::span<const std::uint32_t> words, SpvOp op) {
  Words found;
  for (std::size_t at = kHeaderWords; at < words.size(); at += words[at] >> SpvWordCountShift) {
    const auto instruction = words.subspan(at, words[at] >> SpvWordCountShift);
    if ((instruction[0] & SpvOpCodeMask) == op) found.insert(found.end(), instruction.begin() + 1, instruction.end());
  }
  return found;
}

TEST(Specialization, KeepsTheArmThatIsTaken) {
  const Words left = gpu::specialize(selection(), std::vector<gpu::Constant>{{3, 0}});
  EXPECT_THAT(operands(left, SpvOpLabel), ElementsAre(kEntry, kLeft, kMerge));
  EXPECT_THAT(operands(left, SpvOpBranch), ElementsAre(kLeft, kMerge));
  EXPECT_THAT(operands(left, SpvOpPhi), ElementsAre(kUint, kPhi, kOne, kLeft));
  EXPECT_THAT(operands(left, SpvOpName), ElementsAre(kLeft, 'l')) << "no name without a definition";
  EXPECT_THAT(operands(left, SpvOpSelectionMerge), IsEmpty());

  const Words right = gpu::specialize(selection(), {});
  EXPECT_THAT(operands(right, SpvOpLabel), ElementsAre(kEntry, kRight, kMerge)) << "the default is true";
}

TEST(Specialization, SetsConstants) {
  const Words words = gpu::specialize(selection(), std::vector<gpu::Constant>{{3, 0}});
  EXPECT_THAT(operands(words, SpvOpConstantFalse), ElementsAre(kBool, kSpec));
  EXPECT_THAT(operands(words, SpvOpConstantTrue), ElementsAre(kBool, kNot));
  EXPECT_THAT(operands(words, SpvOpDecorate), IsEmpty());
}

TEST(Specialization, KeepsContinueTargetsOfLoopsThatEndAtOnce) {
  const Words words = gpu::specialize(loop(), std::vector<gpu::Constant>{{3, 1}});
  EXPECT_THAT(operands(words, SpvOpLabel), ElementsAre(kEntry, kHeader, kBody, kLeft, kContinue, kMerge));
  EXPECT_THAT(operands(words, SpvOpIAdd), IsEmpty());
  EXPECT_THAT(operands(words, SpvOpUndef), ElementsAre(kUint, kBound));
  EXPECT_THAT(operands(words, SpvOpPhi), ElementsAre(kUint, kPhi, kOne, kEntry, kBound, kContinue));
  EXPECT_THAT(operands(words, SpvOpBranch), ElementsAre(kHeader, kBody, kLeft, kMerge, kHeader));
  EXPECT_EQ(words[3], kBound + 1) << "bound of the ids";
}

TEST(Specialization, KeepsLoopsThatGoOn) {
  const Words words = gpu::specialize(loop(), std::vector<gpu::Constant>{{3, 0}});
  EXPECT_THAT(operands(words, SpvOpLabel), ElementsAre(kEntry, kHeader, kBody, kRight, kContinue, kMerge));
  EXPECT_THAT(operands(words, SpvOpPhi), ElementsAre(kUint, kPhi, kOne, kEntry, kSum, kContinue));
}

// A pass without any kind of object, search, friction or state.
TEST(Specialization, RemovesMostOfAPass) {
  const gpu::Reflection before = gpu::reflect(k_contact_spirv);
  std::vector<gpu::Constant> constants;
  for (const std::uint32_t id : before.constants) constants.push_back({id, 0});
  const Words words = gpu::specialize(k_contact_spirv, constants);
  EXPECT_LT(10 * words.size(), 3 * std::size(k_contact_spirv));
  const gpu::Reflection after = gpu::reflect(words);
  EXPECT_THAT(after.constants, IsEmpty());
  EXPECT_EQ(after.buffers, before.buffers);
}

}  // namespace
}  // namespace taxelsim
