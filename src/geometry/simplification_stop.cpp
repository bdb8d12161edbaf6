#include "taxelsim/simplification_stop.h"

#include "geometry/triangle_tree.h"

namespace taxelsim {
namespace {

thread_local const std::atomic<bool>* current = nullptr;

}  // namespace

SimplificationStop::SimplificationStop(const std::atomic<bool>& stop) : outer_(current) {
  current = &stop;
}

SimplificationStop::~SimplificationStop() {
  current = outer_;
}

const std::atomic<bool>* stopOfThisThread() {
  return current;
}

}  // namespace taxelsim
