/// @file
/// The type of contact that an image shows.
#pragma once

namespace taxelsim {

/// Type of a contact, from the length and width of an equivalent patch of uniform pressure.
///
/// That patch has the second moments of the image, less those of the point spread and of the taxels themselves. Its length and width are
/// compared with the pitch along the same direction; for taxels of several patches, or of a list, with the side of a square of their mean
/// area. The width of the array is that of even pressure on all taxels, or on those of the row's patch, along the direction of the width.
enum class ContactType {
  kNone,   ///< Total force at most 5 standard deviations of the noise of all taxels together.
  kPoint,  ///< Length at most 2.5 taxels.
  kEdge,   ///< Width at most half the length, and at most 2.5 taxels or less than 0.9 of the array's width.
  kArea,   ///< Any other contact.
};

}  // namespace taxelsim
