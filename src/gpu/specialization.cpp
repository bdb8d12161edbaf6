// Sparse conditional constant propagation over bools and words of 32 bits (Wegman and Zadeck 1991): a block counts as executed once an
// executed branch leads to it, a value as known while all executed definitions agree. Then the selections with a known condition become
// branches, and blocks that are never executed are left out.
#include "gpu/specialization.h"

#define SPV_ENABLE_UTILITY_CODE
#include <spirv_cross/spirv.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace taxelsim::gpu {
namespace {

using Words = std::span<const std::uint32_t>;

constexpr std::size_t kHeaderWords = 5, kBoundWord = 3;

SpvOp opOf(Words instruction) {
  return static_cast<SpvOp>(instruction[0] & SpvOpCodeMask);
}

std::uint32_t resultOf(Words instruction) {
  bool has_result = false, has_type = false;
  SpvHasResultAndType(opOf(instruction), &has_result, &has_type);
  return has_result ? instruction[has_type ? 2 : 1] : 0;
}

// Result of an operation on integers or bools; nothing for operations that are not folded.
std::optional<std::uint32_t> folded(SpvOp op, std::uint32_t a, std::uint32_t b) {
  const auto as_signed = [](std::uint32_t word) { return static_cast<std::int32_t>(word); };
  switch (op) {
    case SpvOpIAdd:
      return a + b;
    case SpvOpISub:
      return a - b;
    case SpvOpIMul:
      return a * b;
    case SpvOpUDiv:
      return b == 0 ? std::nullopt : std::optional(a / b);
    case SpvOpUMod:
      return b == 0 ? std::nullopt : std::optional(a % b);
    case SpvOpShiftLeftLogical:
      return b > 31 ? std::nullopt : std::optional(a << b);
    case SpvOpShiftRightLogical:
      return b > 31 ? std::nullopt : std::optional(a >> b);
    case SpvOpBitwiseAnd:
    case SpvOpLogicalAnd:
      return a & b;
    case SpvOpBitwiseOr:
    case SpvOpLogicalOr:
      return a | b;
    case SpvOpIEqual:
    case SpvOpLogicalEqual:
      return a == b;
    case SpvOpINotEqual:
    case SpvOpLogicalNotEqual:
      return a != b;
    case SpvOpUGreaterThan:
      return a > b;
    case SpvOpUGreaterThanEqual:
      return a >= b;
    case SpvOpULessThan:
      return a < b;
    case SpvOpULessThanEqual:
      return a <= b;
    case SpvOpSGreaterThan:
      return as_signed(a) > as_signed(b);
    case SpvOpSGreaterThanEqual:
      return as_signed(a) >= as_signed(b);
    case SpvOpSLessThan:
      return as_signed(a) < as_signed(b);
    case SpvOpSLessThanEqual:
      return as_signed(a) <= as_signed(b);
    default:
      return {};
  }
}

struct Value {
  enum class State { kUnseen, kKnown, kVarying };
  State state = State::kVarying;
  std::uint32_t word = 0;
  bool operator==(const Value&) const = default;
  bool is(std::uint32_t known) const { return state == State::kKnown && word == known; }
};

Value known(std::uint32_t word) {
  return {Value::State::kKnown, word};
}

// Instructions [first, last) of a block, from its label to its branch.
struct Block {
  std::size_t first = 0, last = 0;
  std::uint32_t label = 0;
  bool executed = false;
};

class Specializer {
 public:
  Specializer(Words spirv, std::span<const Constant> constants) : spirv_(spirv), bound_(spirv[kBoundWord]), values_(bound_) {
    for (std::size_t at = kHeaderWords; at < spirv.size(); at += spirv[at] >> SpvWordCountShift) {
      instructions_.push_back(spirv.subspan(at, spirv[at] >> SpvWordCountShift));
    }
    num_globals_ = static_cast<std::size_t>(
        std::find_if(instructions_.begin(), instructions_.end(), [](Words i) { return opOf(i) == SpvOpFunction; }) - instructions_.begin());
    for (std::size_t i = 0; i < num_globals_; ++i) readGlobal(instructions_[i], constants);
    findBlocks();
    for (changed_ = true; changed_;) {
      changed_ = false;
      for (const Block& block : blocks_) {
        if (block.executed) propagate(block);
      }
    }
  }

  std::vector<std::uint32_t> module() {
    findStubs();
    std::vector<std::uint32_t> functions;
    for (std::size_t i = num_globals_, block = 0; i < instructions_.size();) {
      if (block < blocks_.size() && blocks_[block].first == i) {
        i = blocks_[block].last;
        append(functions, blocks_[block++]);
      } else {
        append(functions, instructions_[i++]);
      }
    }
    std::vector<std::uint32_t> out(spirv_.begin(), spirv_.begin() + kHeaderWords);
    for (std::size_t i = 0; i < num_globals_; ++i) appendGlobal(out, instructions_[i]);
    for (const auto& [type, id] : undefined_) append(out, SpvOpUndef, {type, id});
    out[kBoundWord] = bound_;
    out.insert(out.end(), functions.begin(), functions.end());
    return out;
  }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // labels from, to

  void readGlobal(Words i, std::span<const Constant> constants) {
    switch (opOf(i)) {
      case SpvOpDecorate:
        if (i[2] != SpvDecorationSpecId) break;
        for (const Constant& constant : constants) {
          if (constant.id == i[3]) given_[i[1]] = constant.value;
        }
        break;
      case SpvOpTypeBool:
        bool_type_ = i[1];
        break;
      case SpvOpConstantTrue:
      case SpvOpSpecConstantTrue:
        values_[i[2]] = known(given(i[2], 1) != 0);
        break;
      case SpvOpConstantFalse:
      case SpvOpSpecConstantFalse:
        values_[i[2]] = known(given(i[2], 0) != 0);
        break;
      case SpvOpConstant:
      case SpvOpSpecConstant:
        if (i.size() == 4) values_[i[2]] = known(given(i[2], i[3]));
        break;
      case SpvOpSpecConstantOp:
        values_[i[2]] = computed(static_cast<SpvOp>(i[3]), i.subspan(4));
        break;
      default:
        break;
    }
  }

  std::uint32_t given(std::uint32_t id, std::uint32_t otherwise) const {
    const auto found = given_.find(id);
    return found == given_.end() ? otherwise : found->second;
  }

  void findBlocks() {
    for (std::size_t i = num_globals_; i < instructions_.size(); ++i) {
      const Words instruction = instructions_[i];
      const SpvOp op = opOf(instruction);
      if (op == SpvOpFunctionEnd) continue;
      if (op == SpvOpLabel) {
        const bool is_entry = opOf(instructions_[i - 1]) == SpvOpFunction || opOf(instructions_[i - 1]) == SpvOpFunctionParameter;
        block_of_[instruction[1]] = blocks_.size();
        blocks_.push_back({i, i, instruction[1], is_entry});
      } else if (const std::uint32_t result = resultOf(instruction); result != 0 && op != SpvOpFunction && op != SpvOpFunctionParameter) {
        values_[result].state = Value::State::kUnseen;
      }
      if (!blocks_.empty()) blocks_.back().last = i + 1;
    }
  }

  // Of an operation on ids.
  Value computed(SpvOp op, Words ids) const {
    using State = Value::State;
    if (op == SpvOpSelect) {
      const Value& condition = values_[ids[0]];
      return condition.state == State::kKnown ? values_[ids[condition.word != 0 ? 1 : 2]] : condition;
    }
    if (op == SpvOpLogicalNot || op == SpvOpNot) {
      Value value = values_[ids[0]];
      if (value.state == State::kKnown) value.word = op == SpvOpNot ? ~value.word : value.word ^ 1u;
      return value;
    }
    if (ids.size() != 2 || !folded(op, 1, 1)) return {};
    const Value& a = values_[ids[0]];
    const Value& b = values_[ids[1]];
    if (op == SpvOpLogicalAnd && (a.is(0) || b.is(0))) return known(0);
    if (op == SpvOpLogicalOr && (a.is(1) || b.is(1))) return known(1);
    if (a.state == State::kVarying || b.state == State::kVarying) return {};
    if (a.state == State::kUnseen || b.state == State::kUnseen) return {State::kUnseen};
    const std::optional<std::uint32_t> word = folded(op, a.word, b.word);
    return word ? known(*word) : Value{};
  }

  // Where executed branches lead here from, all values must agree.
  Value merged(Words phi, std::uint32_t label) const {
    Value value{Value::State::kUnseen};
    for (std::size_t k = 3; k + 1 < phi.size(); k += 2) {
      if (!edges_.contains({phi[k + 1], label})) continue;
      const Value& other = values_[phi[k]];
      if (other.state == Value::State::kUnseen) continue;
      if (value.state == Value::State::kUnseen) value = other;
      if (!(value == other)) return {};
    }
    return value;
  }

  void propagate(const Block& block) {
    for (std::size_t k = block.first; k < block.last; ++k) {
      const Words i = instructions_[k];
      const std::uint32_t result = opOf(i) == SpvOpLabel ? 0 : resultOf(i);
      if (result == 0 || values_[result].state == Value::State::kVarying) continue;
      const Value value = opOf(i) == SpvOpPhi ? merged(i, block.label) : computed(opOf(i), i.subspan(3));
      if (value == values_[result]) continue;
      values_[result] = values_[result].state == Value::State::kKnown ? Value{} : value;
      changed_ = true;
    }
    for (const std::uint32_t target : targetsOf(block)) {
      if (!edges_.insert({block.label, target}).second) continue;
      blocks_[block_of_.at(target)].executed = true;
      changed_ = true;
    }
  }

  // The branch that a selection with a known condition takes, 0 for other blocks.
  std::uint32_t onlyTarget(const Block& block) const {
    const Words branch = instructions_[block.last - 1];
    if (opOf(branch) != SpvOpBranchConditional || opOf(instructions_[block.last - 2]) != SpvOpSelectionMerge) return 0;
    const Value& condition = values_[branch[1]];
    return condition.state == Value::State::kKnown ? branch[condition.word != 0 ? 2 : 3] : 0;
  }

  std::vector<std::uint32_t> targetsOf(const Block& block) const {
    if (const std::uint32_t only = onlyTarget(block); only != 0) return {only};
    const Words branch = instructions_[block.last - 1];
    switch (opOf(branch)) {
      case SpvOpBranch:
        return {branch[1]};
      case SpvOpBranchConditional:
        return {branch[2], branch[3]};
      case SpvOpSwitch: {
        std::vector<std::uint32_t> targets{branch[2]};
        for (std::size_t k = 4; k < branch.size(); k += 2) targets.push_back(branch[k]);
        return targets;
      }
      default:
        return {};
    }
  }

  // Executed loops and selections keep their merge blocks and continue targets, without contents where these are not executed.
  void findStubs() {
    for (const Block& block : blocks_) {
      if (!block.executed || block.last - block.first < 3 || onlyTarget(block) != 0) continue;
      const Words merge = instructions_[block.last - 2];
      const bool is_loop = opOf(merge) == SpvOpLoopMerge;
      if (!is_loop && opOf(merge) != SpvOpSelectionMerge) continue;
      if (!isExecuted(merge[1])) stubs_.insert({merge[1], 0});
      if (is_loop && !isExecuted(merge[2])) {
        stubs_[merge[2]] = block.label;
        continued_by_[block.label] = merge[2];
      }
    }
    for (const Block& block : blocks_) {
      if (block.executed) continue;
      for (std::size_t k = block.first; k < block.last; ++k) {
        const std::uint32_t result = resultOf(instructions_[k]);
        if (result != 0 && !stubs_.contains(result)) removed_.insert(result);
      }
    }
  }

  bool isExecuted(std::uint32_t label) const { return blocks_[block_of_.at(label)].executed; }

  static void append(std::vector<std::uint32_t>& out, Words instruction) { out.insert(out.end(), instruction.begin(), instruction.end()); }

  static void append(std::vector<std::uint32_t>& out, SpvOp op, std::initializer_list<std::uint32_t> operands) {
    out.push_back(static_cast<std::uint32_t>(operands.size() + 1) << SpvWordCountShift | op);
    out.insert(out.end(), operands);
  }

  void append(std::vector<std::uint32_t>& out, const Block& block) {
    if (!block.executed) {
      const auto stub = stubs_.find(block.label);
      if (stub == stubs_.end()) return;
      append(out, SpvOpLabel, {block.label});
      if (stub->second == 0) return append(out, SpvOpUnreachable, {});
      return append(out, SpvOpBranch, {stub->second});
    }
    const std::uint32_t only = onlyTarget(block);
    for (std::size_t k = block.first; k < block.last - (only != 0 ? 2 : 0); ++k) {
      if (opOf(instructions_[k]) == SpvOpPhi) {
        appendPhi(out, instructions_[k], block.label);
      } else {
        append(out, instructions_[k]);
      }
    }
    if (only != 0) append(out, SpvOpBranch, {only});
  }

  void appendPhi(std::vector<std::uint32_t>& out, Words phi, std::uint32_t label) {
    const std::size_t start = out.size();
    append(out, phi.first(3));
    for (std::size_t k = 3; k + 1 < phi.size(); k += 2) {
      if (edges_.contains({phi[k + 1], label})) append(out, phi.subspan(k, 2));
    }
    if (const auto stub = continued_by_.find(label); stub != continued_by_.end()) {
      const auto [undefined, is_new] = undefined_.insert({phi[1], bound_});
      if (is_new) ++bound_;
      out.insert(out.end(), {undefined->second, stub->second});
    }
    out[start] = static_cast<std::uint32_t>(out.size() - start) << SpvWordCountShift | SpvOpPhi;
  }

  void appendGlobal(std::vector<std::uint32_t>& out, Words i) const {
    const SpvOp op = opOf(i);
    switch (op) {
      case SpvOpName:
        if (removed_.contains(i[1])) return;
        break;
      case SpvOpDecorate:
        if (i[2] == SpvDecorationSpecId || removed_.contains(i[1])) return;
        break;
      case SpvOpSpecConstantTrue:
      case SpvOpSpecConstantFalse:
      case SpvOpSpecConstant:
      case SpvOpSpecConstantOp: {
        const Value& value = values_[i[2]];
        if (value.state != Value::State::kKnown) break;
        if (i[1] == bool_type_) return append(out, value.word != 0 ? SpvOpConstantTrue : SpvOpConstantFalse, {i[1], i[2]});
        return append(out, SpvOpConstant, {i[1], i[2], value.word});
      }
      default:
        break;
    }
    append(out, i);
  }

  Words spirv_;
  std::uint32_t bound_ = 0;
  std::uint32_t bool_type_ = 0;
  std::size_t num_globals_ = 0;  // instructions before the first function
  std::vector<Words> instructions_;
  std::map<std::uint32_t, std::uint32_t> given_;  // values of specialization constants by id
  std::vector<Value> values_;                     // by id
  std::vector<Block> blocks_;
  std::map<std::uint32_t, std::size_t> block_of_;  // by label
  std::set<Edge> edges_;                           // executed
  bool changed_ = false;
  std::map<std::uint32_t, std::uint32_t> stubs_;         // label of a block without contents: label of the loop that it continues, or 0
  std::map<std::uint32_t, std::uint32_t> continued_by_;  // the reverse
  std::set<std::uint32_t> removed_;                      // ids without a definition
  std::map<std::uint32_t, std::uint32_t> undefined_;     // type: id of an undefined value
};

}  // namespace

std::vector<std::uint32_t> specialize(std::span<const std::uint32_t> spirv, std::span<const Constant> constants) {
  return Specializer(spirv, constants).module();
}

}  // namespace taxelsim::gpu
