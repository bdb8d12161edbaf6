// Sizes and times of an animated WebP.
#pragma once

#include <webp/mux.h>

#include "support/temporary_directory.h"
#include "support/test.h"

namespace taxelsim::testing {

struct MovingPicture {
  int width = 0, height = 0;     // pixels
  std::vector<int> durations{};  // ms, of the pictures

  explicit MovingPicture(const std::filesystem::path& file) {
    const std::string bytes = contentOf(file);
    const WebPData data{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
    const std::unique_ptr<WebPMux, decltype(&WebPMuxDelete)> mux(WebPMuxCreate(&data, 1), WebPMuxDelete);
    if (!mux) throw std::runtime_error(file.string() + " is no WebP");
    WebPMuxGetCanvasSize(mux.get(), &width, &height);
    WebPMuxFrameInfo frame;
    for (std::uint32_t k = 1; WebPMuxGetFrame(mux.get(), k, &frame) == WEBP_MUX_OK; ++k) {
      durations.push_back(frame.duration);
      WebPDataClear(&frame.bitstream);
    }
  }
};

}  // namespace taxelsim::testing
