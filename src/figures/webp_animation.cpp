#include "figures/webp_animation.h"

#include <spdlog/fmt/fmt.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <span>
#include <string>

#include "base/files.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr std::uint32_t kWhite = 0xffffffff;
constexpr int kQuality = 70;      // 0 to 100
constexpr float kExactness = 95;  // 0 to 100: how little a block must differ from that of the picture before to be left out
constexpr int kMethod = 4;        // 0 (fast) to 6 (small)

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorKind::kInput, "cannot encode the moving picture: " + why);
}

WebPConfig configuration() {
  WebPConfig config;
  if (WebPConfigInit(&config) == 0) fail("libwebp has another version");
  config.quality = kExactness;
  config.qmax = kQuality;
  config.method = kMethod;
  return config;
}

}  // namespace

void WebpAnimation::Free::operator()(WebPAnimEncoder* encoder) const {
  WebPAnimEncoderDelete(encoder);
}

void WebpAnimation::add(const Pixels& picture, int end) {
  if (!encoder_) {
    WebPAnimEncoderOptions options;
    if (WebPAnimEncoderOptionsInit(&options) == 0) fail("libwebpmux has another version");
    options.anim_params.bgcolor = kWhite;
    width_ = picture.width, height_ = picture.height;
    encoder_.reset(WebPAnimEncoderNew(static_cast<int>(width_), static_cast<int>(height_), &options));
    if (!encoder_) fail(fmt::format("{} x {} pixels", width_, height_));
  }
  if (picture.width != width_ || picture.height != height_) fail("pictures differ in size");
  const WebPConfig config = configuration();
  WebPPicture frame;
  if (WebPPictureInit(&frame) == 0) fail("libwebp has another version");
  frame.width = static_cast<int>(width_), frame.height = static_cast<int>(height_), frame.use_argb = 1;
  const bool is_added = WebPPictureImportRGB(&frame, picture.values.data(), static_cast<int>(3 * width_)) != 0 &&
                        WebPAnimEncoderAdd(encoder_.get(), &frame, end_, &config) != 0;
  WebPPictureFree(&frame);
  if (!is_added) fail(WebPAnimEncoderGetError(encoder_.get()));
  end_ = end;
}

void WebpAnimation::save(const std::filesystem::path& file) {
  WebPData data;
  WebPDataInit(&data);
  const bool is_whole =
      encoder_ && WebPAnimEncoderAdd(encoder_.get(), nullptr, end_, nullptr) != 0 && WebPAnimEncoderAssemble(encoder_.get(), &data) != 0;
  const std::unique_ptr<WebPData, decltype(&WebPDataClear)> owner(&data, WebPDataClear);
  if (!is_whole) fail(encoder_ ? WebPAnimEncoderGetError(encoder_.get()) : "there is no picture");
  writeFileAtomically(file, std::as_bytes(std::span(data.bytes, data.size)));
}

}  // namespace taxelsim::figures
