// Objects -> the records that the contact pass reads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/layout.h"
#include "taxelsim/object.h"

namespace taxelsim {

struct PackedObjects {
  std::vector<layout::ObjectRecord> objects;
  std::vector<layout::BoundsRecord> groups;
  std::vector<layout::BoundsRecord> clusters;
  std::vector<std::uint32_t> triangles;
};

PackedObjects packObjects(std::span<const Object> objects);

}  // namespace taxelsim
