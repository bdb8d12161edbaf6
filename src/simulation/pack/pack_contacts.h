// Contacts from another engine -> the records that shaders/contacts.comp reads.
#pragma once

#include <cstddef>
#include <span>

#include "shared/batch.h"
#include "taxelsim/contact_point.h"

namespace taxelsim {

// Throws Error(kInput), naming instance and contact, for what one instance may not be given.
void checkContacts(std::span<const ContactPoint> contacts, std::size_t instance, int max_contacts);

// Throws Error(kInput) unless `offsets` rises from 0 to the number of contacts.
void checkOffsets(std::span<const int> offsets, std::size_t num_contacts);

layout::ContactRecord packContact(const ContactPoint& contact);

}  // namespace taxelsim
