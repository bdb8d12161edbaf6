#include "simulation/pack/pack_contacts.h"

#include <cmath>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorKind::kInput, what);
}

// Comparisons written so that NaN fails.
bool isPlace(double coordinate) {
  return std::abs(coordinate) <= kMaxContactCoordinate;
}
bool isForce(double force) {
  return force >= 0 && force <= kMaxContactForce;
}

[[noreturn]] void refuseContact(const ContactPoint& contact, std::size_t instance, std::size_t number) {
  const std::string where = " of contact " + std::to_string(number) + " of instance " + std::to_string(instance) + ": ";
  for (const double coordinate : contact.position) {
    if (!isPlace(coordinate)) refuse("position" + where + std::to_string(coordinate) + " is not allowed: -1e6 to 1e6 m");
  }
  refuse("normal_force" + where + std::to_string(contact.normal_force) + " is not allowed: 0 to 1e6 N");
}

}  // namespace

void checkContacts(std::span<const ContactPoint> contacts, std::size_t instance, int max_contacts) {
  if (contacts.size() > static_cast<std::size_t>(max_contacts)) {
    refuse("contacts of instance " + std::to_string(instance) + ": " + std::to_string(contacts.size()) + " are too many: max_contacts is " +
           std::to_string(max_contacts));
  }
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto& [x, y, z] = contacts[k].position;
    if (!isPlace(x) || !isPlace(y) || !isPlace(z) || !isForce(contacts[k].normal_force)) refuseContact(contacts[k], instance, k);
  }
}

void checkOffsets(std::span<const int> offsets, std::size_t num_contacts) {
  if (offsets.front() != 0) refuse("offsets[0]: " + std::to_string(offsets.front()) + " is not allowed: 0");
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    if (offsets[i] >= offsets[i - 1]) continue;
    refuse("offsets[" + std::to_string(i) + "]: " + std::to_string(offsets[i]) + " is not allowed: at least offsets[" +
           std::to_string(i - 1) + "] = " + std::to_string(offsets[i - 1]));
  }
  if (static_cast<std::size_t>(offsets.back()) == num_contacts) return;
  refuse("offsets[" + std::to_string(offsets.size() - 1) + "]: " + std::to_string(offsets.back()) + " is not allowed: the " +
         std::to_string(num_contacts) + " contacts that there are");
}

layout::ContactRecord packContact(const ContactPoint& contact) {
  return {{static_cast<float>(contact.position[0]), static_cast<float>(contact.position[1]), static_cast<float>(contact.position[2]),
           static_cast<float>(contact.normal_force)}};
}

}  // namespace taxelsim
