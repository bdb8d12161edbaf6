/// @file
/// The type of contact that an image shows.
#pragma once

namespace taxelsim {

/// Type of a contact, from the length and width of an equivalent patch of uniform pressure.
///
/// That patch has the second moments of the image, less those of the point spread and of the taxels themselves. The unit of length is the
/// pitch along the patch's length. For taxels of several patches, or of a list, it is the side of a square of their mean area.
enum class ContactType {
  kNone,   ///< Total force at most 5 standard deviations of the noise of all taxels together.
  kPoint,  ///< Length at most 2.5 taxels.
  kEdge,   ///< Width at most half the length.
  kArea,   ///< Any other contact.
};

}  // namespace taxelsim
