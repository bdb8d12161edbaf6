// Moving pictures as animated WebP, which browsers show and repeat without end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "figures/canvas.h"

struct WebPAnimEncoder;

namespace taxelsim::figures {

class WebpAnimation {
 public:
  // Adds a picture that is shown until `end` (ms, > 0, larger than that of the picture before). All have the size of the first. Equal
  // pictures that follow each other become one. Throws Error(kInput) for another size, and for a size that WebP cannot hold.
  void add(const Pixels& picture, int end);

  // Writes all pictures, whole or not at all. At least one was added; none can be added later. Throws Error(kIo) if the file cannot be
  // written.
  void save(const std::filesystem::path& file);

 private:
  struct Free {
    void operator()(WebPAnimEncoder* encoder) const;
  };

  std::unique_ptr<WebPAnimEncoder, Free> encoder_;
  std::size_t width_ = 0, height_ = 0;  // pixels
  int end_ = 0;                         // ms, of the last picture
};

}  // namespace taxelsim::figures
