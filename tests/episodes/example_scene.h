// A small scene for tests, built without a file: a 6 x 14 array, a cylinder lying on it and a sphere.
#pragma once

#include <filesystem>

#include "taxelsim/scene.h"

namespace taxelsim {

// A servo scene of 23 episodes of 7 frames, in shards of 5; everything is recorded and everything is random.
Scene exampleScene();

// The same as labelled contacts: one frame per episode.
Scene exampleContacts();

// A directory under the system's temporary one, named after the running test; removed when this goes.
class TestDirectory {
 public:
  TestDirectory();
  ~TestDirectory();
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace taxelsim
