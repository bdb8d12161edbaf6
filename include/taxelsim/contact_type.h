// What kind of contact an image shows.
#pragma once

namespace taxelsim {

// From the length and width of the patch of even pressure that has the image's second moments, less those of the spread and of the taxels
// themselves. A taxel is the pitch along the length; of taxels of several patches, or of a list, the side of a square of their mean area.
enum class ContactType {
  kNone,   // no more force than 5 standard deviations of the noise of all taxels together
  kPoint,  // no longer than 2.5 taxels
  kEdge,   // no wider than half its length
  kArea,
};

}  // namespace taxelsim
