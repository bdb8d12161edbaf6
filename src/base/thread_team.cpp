#include "base/thread_team.h"

namespace taxelsim {

ThreadTeam::ThreadTeam(int num_threads) {
  try {
    for (int part = 1; part < num_threads; ++part) threads_.emplace_back([this, part] { work(part); });
  } catch (...) {
    stop();
    throw;
  }
}

ThreadTeam::~ThreadTeam() {
  stop();
}

void ThreadTeam::stop() {
  closing_ = true;
  ++loop_;
  loop_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::runPart(int part) const {
  const auto bound = [&](int k) { return static_cast<int>(static_cast<std::int64_t>(count_) * k / numThreads()); };
  call_(job_, bound(part), bound(part + 1));
}

void ThreadTeam::share() {
  num_running_ = static_cast<int>(threads_.size());
  ++loop_;
  loop_.notify_all();
  runPart(0);
  for (int running = num_running_; running != 0; running = num_running_) num_running_.wait(running);
}

void ThreadTeam::work(int part) {
  for (std::uint32_t seen = 0;;) {
    loop_.wait(seen);
    ++seen;  // share() waits for all threads, so that none misses a loop
    if (closing_) return;
    runPart(part);
    if (--num_running_ == 0) num_running_.notify_one();
  }
}

}  // namespace taxelsim
