#include "cli/contacts_file.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 20;  // 256 bytes for each contact that a sensor takes
constexpr std::array<const char*, 4> kColumns{"x", "y", "z", "normal_force"};
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// One line without its comment, whatever the locale.
ContactPoint parseContact(std::string_view line, const std::string& where) {
  std::array<double, 4> numbers{};
  for (std::size_t column = 0; column < numbers.size(); ++column) {
    const std::size_t comma = line.find(',');
    const bool is_last = column + 1 == numbers.size();
    if ((comma == std::string_view::npos) != is_last)
      throw Error(ErrorKind::kInput, where + ": a contact is four numbers with commas between, \"x,y,z,normal_force\", m and N");
    const std::string_view text = trimmed(line.substr(0, comma));
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), numbers[column]);
    const double least = is_last ? 0 : -kMaxContactCoordinate;
    const double most = is_last ? kMaxContactForce : kMaxContactCoordinate;
    if (problem != std::errc() || end != text.data() + text.size() || !(numbers[column] >= least && numbers[column] <= most))
      throw Error(ErrorKind::kInput, fmt::format("{}: {}: \"{}\" is not allowed: a number from {:g} to {:g} {}", where, kColumns[column],
                                                 text, least, most, is_last ? "N" : "m"));
    if (!is_last) line.remove_prefix(comma + 1);
  }
  return {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

}  // namespace

std::vector<ContactPoint> readContacts(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) { return Error(ErrorKind::kInput, file.string() + ": " + what); };
  std::error_code problem;
  if (!std::filesystem::is_regular_file(file, problem)) throw refuse("no such file");
  if (std::filesystem::file_size(file, problem) > kMaxFileBytes) throw refuse("larger than 1 MiB");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw refuse("cannot be read");
  std::vector<ContactPoint> contacts;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view text = trimmed(std::string_view(line).substr(0, line.find('#')));
    if (text.empty()) continue;
    if (contacts.size() == static_cast<std::size_t>(kMaxContacts))
      throw refuse(fmt::format("{}: more than {} contacts", number, kMaxContacts));
    contacts.push_back(parseContact(text, fmt::format("{}:{}", file.string(), number)));
  }
  return contacts;
}

}  // namespace taxelsim::cli
