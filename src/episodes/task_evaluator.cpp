#include "episodes/task_evaluator.h"

namespace taxelsim {

std::optional<std::uint64_t> TaskEvaluator::next(int) {
  if (next_ == verdicts_.size()) return {};
  return first_episode_ + next_++;
}

void TaskEvaluator::end(int instance) {
  const Verdict verdict = judge_.verdict(instance);
  verdicts_[verdict.episode - first_episode_] = verdict;
}

}  // namespace taxelsim
