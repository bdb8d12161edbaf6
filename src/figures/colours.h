// Colours and colour scales that all figures share, without Cairo.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace taxelsim::figures {

struct Colour {
  double red = 0, green = 0, blue = 0;  // 0 to 1
};

constexpr Colour rgb(unsigned code) {
  return {(code >> 16) / 255.0, (code >> 8 & 255) / 255.0, (code & 255) / 255.0};
}

inline constexpr Colour kInk = rgb(0x1f2430), kGrey = rgb(0x6b7280), kPaper = rgb(0xffffff), kGap = rgb(0xe8eaee);
inline constexpr Colour kRed = rgb(0xe5322d), kBlue = rgb(0x2f7de1), kGreen = rgb(0x18a35a);

// Viridis (Smith, van der Walt and Firing, 2015) at eleven equidistant places: perceptually uniform, readable in grey and with colour
// vision deficiency.
inline constexpr std::array<Colour, 11> kViridis{rgb(0x440154), rgb(0x482475), rgb(0x414487), rgb(0x355f8d), rgb(0x2a788e), rgb(0x21918c),
                                                 rgb(0x22a884), rgb(0x44bf70), rgb(0x7ad151), rgb(0xbddf26), rgb(0xfde725)};
// For differences: equal lightness on both sides of 0.
inline constexpr std::array<Colour, 5> kBlueToRed{rgb(0x2b5fa8), rgb(0x8fb3dd), rgb(0xeeeff1), rgb(0xe8a58f), rgb(0xb5372b)};

// Interpolates equidistant colours at t, 0 to 1.
constexpr Colour along(std::span<const Colour> colours, double t) {
  const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(colours.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  const double f = place - static_cast<double>(i);
  const auto mix = [f](double from, double to) { return from + f * (to - from); };
  return {mix(colours[i].red, colours[i + 1].red), mix(colours[i].green, colours[i + 1].green), mix(colours[i].blue, colours[i + 1].blue)};
}

}  // namespace taxelsim::figures
