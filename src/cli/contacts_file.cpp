#include "cli/contacts_file.h"

#include <array>

#include "scene/csv_reader.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 20;  // 256 bytes per contact
constexpr std::array<CsvColumn, 4> kColumns{{{"x", -kMaxContactCoordinate, kMaxContactCoordinate, "m"},
                                             {"y", -kMaxContactCoordinate, kMaxContactCoordinate, "m"},
                                             {"z", -kMaxContactCoordinate, kMaxContactCoordinate, "m"},
                                             {"normal_force", 0, kMaxContactForce, "N"}}};

}  // namespace

std::vector<ContactPoint> readContacts(const std::filesystem::path& file) {
  std::vector<ContactPoint> contacts;
  const CsvFormat format{.columns = kColumns,
                         .row = "contact",
                         .has_heading = false,
                         .max_rows = static_cast<std::size_t>(kMaxContacts),
                         .max_bytes = kMaxFileBytes};
  readCsvRows(file, format, [&](std::span<const double> n, const CsvReader&) { contacts.push_back({{n[0], n[1], n[2]}, n[3]}); });
  return contacts;
}

}  // namespace taxelsim::cli
