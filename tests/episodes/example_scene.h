// Scene for tests, built without a file: a 6 x 14 array with a lying cylinder and a sphere.
#pragma once

#include "support/temporary_directory.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Servo scene of 23 episodes with 7 frames each, in shards of 5 episodes. Records all groups of columns and randomizes all parameters.
Scene exampleScene();

// The same scene with kind `contacts`: one frame per episode.
Scene exampleContacts();

// Path in a temporary directory, not created.
class TestDirectory {
 public:
  const std::filesystem::path& path() const { return path_; }

 private:
  testing::TemporaryDirectory root_;
  std::filesystem::path path_ = root_ / "data";
};

}  // namespace taxelsim
