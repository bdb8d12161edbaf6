#include "evaluation/part_text.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "base/files.h"
#include "base/sha256.h"
#include "taxelsim/error.h"
#include "taxelsim/robot.h"

namespace taxelsim {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the bytes of numbers are little-endian");

constexpr int kFormatVersion = 1;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{4} << 30;
constexpr std::size_t kMaxVerdicts = std::size_t{1} << 24;
constexpr const char* kDigits = "0123456789abcdef";

// Calls `visit` with every member of a verdict but the number of its episode, in the order of the text (docs/reference/other_files.md).
template <typename AnyVerdict, typename Visit>
void visitMembers(AnyVerdict& verdict, Visit visit) {
  visit(verdict.object);
  visit(verdict.success);
  visit(verdict.start_error);
  visit(verdict.steady_error);
  visit(verdict.settling_time);
  visit(verdict.travel);
  visit(verdict.laps);
  visit(verdict.peak_force);
  visit(verdict.saturated);
  visit(verdict.num_losses);
  visit(verdict.robot);
  visit(verdict.load_reached);
}

// Visits the members of the verdict on a finger.
template <typename AnyVerdict, typename Visit>
requires std::is_same_v<std::remove_const_t<AnyVerdict>, FingerVerdict>
void visitMembers(AnyVerdict& verdict, Visit visit) {
  visit(verdict.held);
  visit(verdict.target);
  visit(verdict.force_error);
  visit(verdict.settling_time);
  visit(verdict.peak_force);
  visit(verdict.drift);
  visit(verdict.num_losses);
}

// Visits the members of the misses of a finger.
template <typename AnyVerdict, typename Visit>
requires std::is_same_v<std::remove_const_t<AnyVerdict>, ContactMisses>
void visitMembers(AnyVerdict& misses, Visit visit) {
  visit(misses.num_episodes);
  visit(misses.num_misses);
  visit(misses.nearest);
}

template <typename Record>
std::size_t recordBytes() {
  std::size_t size = 0;
  const Record record{};
  visitMembers(record, [&](const auto& member) { size += sizeof member; });
  return size;
}

template <typename Record>
void appendDigits(std::string& digits, const Record& record) {
  visitMembers(record, [&](const auto& member) {
    for (const std::byte byte : std::as_bytes(std::span(&member, 1))) {
      digits += kDigits[std::to_integer<unsigned>(byte >> 4)];
      digits += kDigits[std::to_integer<unsigned>(byte & std::byte{15})];
    }
  });
}

class Parser {
 public:
  Parser(const std::string& text, const std::string& name) : name_(name) {
    json_ = Json::parse(text, nullptr, false);
    if (!json_.is_object() || !json_.contains("evaluation_part")) fail("is not part of an evaluation by taxelsim");
    const auto version = unsignedOf(json_, "evaluation_part");
    if (version != kFormatVersion) fail("has format " + std::to_string(version) + ", this program reads " + std::to_string(kFormatVersion));
    const std::string expected = textOf(json_, "sha256");
    json_.erase("sha256");
    const std::string content = json_.dump();
    if (sha256Hex(std::as_bytes(std::span(content))) != expected) fail("its content differs from its SHA-256: it was damaged or altered");
  }

  EvaluationPart part() const {
    EvaluationPart part{.program_version = textOf(json_, "program_version"),
                        .device = textOf(json_, "device"),
                        .probe_sha256 = textOf(json_, "probe_sha256"),
                        .scene = textOf(json_, "scene"),
                        .condition = textOf(json_, "condition"),
                        .seed = unsignedOf(json_, "seed"),
                        .num_episodes = unsignedOf(json_, "num_episodes"),
                        .policy = textOf(json_, "policy"),
                        .episodes = {.first = unsignedOf(json_, "first_episode"), .end = unsignedOf(json_, "end_episode")},
                        .evaluations = {}};
    const auto& [first, end] = part.episodes;
    if (first >= end || end > part.num_episodes || part.num_episodes > kMaxVerdicts)
      fail("episodes " + std::to_string(first) + " to " + std::to_string(end) + " of " + std::to_string(part.num_episodes) + " found");
    for (const Json& evaluation : arrayOf(json_, "evaluations")) part.evaluations.push_back(verdictsOf(evaluation, part.episodes));
    return part;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw Error(ErrorKind::kInput, name_ + ": " + problem); }

  const Json& valueOf(const Json& object, const char* key) const {
    if (!object.is_object() || !object.contains(key)) fail(std::string(key) + " is missing");
    return object[key];
  }
  std::string textOf(const Json& object, const char* key) const {
    const Json& value = valueOf(object, key);
    if (!value.is_string()) fail(std::string(key) + ": a text expected");
    return value.get<std::string>();
  }
  std::uint64_t unsignedOf(const Json& object, const char* key) const {
    const Json& value = valueOf(object, key);
    if (!value.is_number_unsigned()) fail(std::string(key) + ": a whole number expected");
    return value.get<std::uint64_t>();
  }
  const Json& arrayOf(const Json& object, const char* key) const {
    const Json& value = valueOf(object, key);
    if (!value.is_array()) fail(std::string(key) + ": a list expected");
    return value;
  }

  std::byte byteAt(const std::string& digits, std::size_t i) const {
    const char* const high = std::strchr(kDigits, digits[i]);
    const char* const low = std::strchr(kDigits, digits[i + 1]);
    if (digits[i] == '\0' || digits[i + 1] == '\0' || !high || !low) fail("verdicts: digits 0 to f expected");
    return static_cast<std::byte>((high - kDigits) << 4 | (low - kDigits));
  }

  EvaluationPart::Verdicts verdictsOf(const Json& evaluation, const EpisodeRange& episodes) const {
    EvaluationPart::Verdicts read{.controller = textOf(evaluation, "controller"), .verdicts = {}, .grasps = {}, .misses = {}};
    const std::string digits = textOf(evaluation, "verdicts");
    if (!evaluation.contains("num_fingers")) {
      read.verdicts = recordsOf<Verdict>(digits, episodes.size());
      for (std::size_t k = 0; k < read.verdicts.size(); ++k) read.verdicts[k].episode = episodes.first + k;
      return read;
    }
    const std::uint64_t num_fingers = unsignedOf(evaluation, "num_fingers");
    if (num_fingers < 1 || num_fingers > kMaxJoints) fail("num_fingers: " + std::to_string(num_fingers) + " is not allowed");
    read.misses = recordsOf<ContactMisses>(textOf(evaluation, "misses"), num_fingers);
    const std::vector<FingerVerdict> fingers = recordsOf<FingerVerdict>(digits, episodes.size() * num_fingers);
    for (std::uint64_t k = 0; k < episodes.size(); ++k) {
      const auto first = fingers.begin() + static_cast<std::ptrdiff_t>(k * num_fingers);
      GraspVerdict verdict{.episode = episodes.first + k, .fingers = {first, first + static_cast<std::ptrdiff_t>(num_fingers)}};
      verdict.success = std::ranges::all_of(verdict.fingers, &FingerVerdict::held);
      read.grasps.push_back(std::move(verdict));
    }
    return read;
  }

  template <typename Record>
  std::vector<Record> recordsOf(const std::string& digits, std::size_t count) const {
    const std::size_t expected = 2 * recordBytes<Record>() * count;
    if (digits.size() != expected)
      fail("verdicts: " + std::to_string(digits.size()) + " digits are not allowed: " + std::to_string(expected));
    std::vector<Record> records(count);
    std::size_t next = 0;
    const auto read = [&](auto& member) {
      for (std::byte& byte : std::as_writable_bytes(std::span(&member, 1))) {
        byte = byteAt(digits, next);
        next += 2;
      }
    };
    for (Record& record : records) {
      visitMembers(record, [&](auto& member) {
        if constexpr (std::is_same_v<decltype(member), bool&>) {
          std::uint8_t flag = 0;
          read(flag);
          if (flag > 1) fail("verdicts: a flag of value " + std::to_string(flag) + " is not allowed: 0 or 1");
          member = flag != 0;
        } else {
          read(member);
        }
      });
    }
    return records;
  }

  std::string name_;
  Json json_;
};

}  // namespace

std::string digitsOf(std::span<const Verdict> verdicts) {
  std::string digits;
  digits.reserve(2 * recordBytes<Verdict>() * verdicts.size());
  for (const Verdict& verdict : verdicts) appendDigits(digits, verdict);
  return digits;
}

std::string digitsOf(std::span<const GraspVerdict> verdicts) {
  std::string digits;
  for (const GraspVerdict& verdict : verdicts) {
    for (const FingerVerdict& finger : verdict.fingers) appendDigits(digits, finger);
  }
  return digits;
}

std::string evaluationPartText(const EvaluationPart& part) {
  Json json{{"evaluation_part", kFormatVersion},
            {"program_version", part.program_version},
            {"device", part.device},
            {"probe_sha256", part.probe_sha256},
            {"scene", part.scene},
            {"condition", part.condition},
            {"seed", part.seed},
            {"num_episodes", part.num_episodes},
            {"policy", part.policy},
            {"first_episode", part.episodes.first},
            {"end_episode", part.episodes.end},
            {"evaluations", Json::array()}};
  for (const EvaluationPart::Verdicts& evaluation : part.evaluations) {
    Json entry{{"controller", evaluation.controller}};
    if (evaluation.grasps.empty()) {
      entry["verdicts"] = digitsOf(evaluation.verdicts);
    } else {
      entry["num_fingers"] = evaluation.misses.size();
      entry["verdicts"] = digitsOf(evaluation.grasps);
      std::string misses;
      for (const ContactMisses& finger : evaluation.misses) appendDigits(misses, finger);
      entry["misses"] = misses;
    }
    json["evaluations"].push_back(std::move(entry));
  }
  const std::string content = json.dump();
  json["sha256"] = sha256Hex(std::as_bytes(std::span(content)));
  return json.dump(1) + "\n";
}

EvaluationPart parseEvaluationPart(const std::string& text, const std::string& name) {
  return Parser(text, name).part();
}

void writeEvaluationPart(const std::filesystem::path& file, const EvaluationPart& part) {
  const std::string text = evaluationPartText(part);
  writeFileAtomically(file, std::as_bytes(std::span(text)));
}

EvaluationPart readEvaluationPart(const std::filesystem::path& file) {
  return parseEvaluationPart(readTextFile(file, kMaxBytes), file.string());
}

}  // namespace taxelsim
