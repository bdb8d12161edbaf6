/// @file
/// Ends the simplification of meshes early, for programs that stop on a signal.
#pragma once

#include <atomic>

namespace taxelsim {

/// While it exists, loadMesh(), parseObject() and loadScene() in this thread stop the simplification of a mesh when `stop` becomes true,
/// and return meshes that are not simplified. Throw these away. Nothing is stored in the user's cache directory.
class SimplificationStop {
 public:
  /// `stop` may be set from any thread. Not owned; must outlive this object.
  explicit SimplificationStop(const std::atomic<bool>& stop);
  ~SimplificationStop();
  SimplificationStop(const SimplificationStop&) = delete;
  SimplificationStop& operator=(const SimplificationStop&) = delete;

 private:
  const std::atomic<bool>* outer_;
};

}  // namespace taxelsim
