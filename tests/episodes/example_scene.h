// Scene for tests, built without a file: a 6 x 14 array with a lying cylinder and a sphere.
#pragma once

#include <filesystem>

#include "taxelsim/scene.h"

namespace taxelsim {

// Servo scene of 23 episodes with 7 frames each, in shards of 5 episodes. Records all groups of columns and randomizes all parameters.
Scene exampleScene();

// The same scene with kind `contacts`: one frame per episode.
Scene exampleContacts();

// Path in the system's temporary directory, named after the running test and not created. Removed by the destructor.
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
