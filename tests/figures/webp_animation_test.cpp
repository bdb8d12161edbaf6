// Moving pictures: size, number and times of their pictures.
#include "figures/webp_animation.h"

#include "cli/moving_picture.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

// A square that moves to the right.
Pixels step(std::size_t k, std::size_t width = 48) {
  Pixels pixels{.width = width, .height = 32, .values = std::vector<std::uint8_t>(3 * width * 32, 255)};
  for (std::size_t y = 8; y < 24; ++y) std::fill_n(pixels.values.begin() + static_cast<std::ptrdiff_t>(3 * (y * width + 8 * k)), 24, 0);
  return pixels;
}

TEST(WebpAnimation, KeepsPicturesAndTimes) {
  const testing::TemporaryDirectory root;
  WebpAnimation animation;
  for (const auto& [k, end] : {std::pair{0, 40}, std::pair{1, 90}, std::pair{3, 100}})
    animation.add(step(static_cast<std::size_t>(k)), end);
  animation.save(root / "a.webp");
  const testing::MovingPicture found(root / "a.webp");
  EXPECT_EQ(std::pair(found.width, found.height), std::pair(48, 32));
  EXPECT_EQ(found.durations, (std::vector<int>{40, 50, 10}));
}

TEST(WebpAnimation, RefusesOtherSizesAndNoPicture) {
  const testing::TemporaryDirectory root;
  WebpAnimation animation;
  EXPECT_THROW(animation.save(root / "a.webp"), Error);
  animation.add(step(0), 40);
  EXPECT_THROW(animation.add(step(1, 50), 80), Error);
  WebpAnimation large;
  EXPECT_THROW(large.add(step(0, 20000), 40), Error) << "WebP has at most 16383 pixels a side";
  EXPECT_FALSE(std::filesystem::exists(root / "a.webp"));
}

}  // namespace
}  // namespace taxelsim::figures
