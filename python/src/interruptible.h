// Long runs of the library that Ctrl-C can stop.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "bind.h"
#include "calling_thread.h"
#include "taxelsim/progress.h"
#include "taxelsim/simplification_stop.h"
#include "without_gil.h"

namespace taxelsim::python {

// Runs `run(on_progress, stop, calling_thread)` in a thread of its own, without the GIL, and returns its result.
//
// The calling thread calls `on_progress` (a Python callable or None) with the newest Report, does the work that the run hands to
// `calling_thread`, and lets Python handle signals. If one of them raises, the run is stopped gracefully, `keep` takes the result of the
// stopped run unless that failed, and then the exception continues.
template <typename Result, typename Report = Progress, typename Run, typename Keep>
Result runInterruptibly(const nb::object& on_progress, Run run, Keep keep) {
  constexpr std::chrono::milliseconds kPollInterval(50);
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::optional<Report> newest;
  CallingThread calling_thread;
  std::optional<Result> result;
  std::exception_ptr failure;

  std::thread worker([&] {
    try {
      result.emplace(run(
          [&](const Report& progress) {
            const std::lock_guard lock(mutex);
            newest = progress;
          },
          stop, calling_thread));
    } catch (...) {
      failure = std::current_exception();
    }
    calling_thread.finish();
  });

  std::exception_ptr raised;
  try {
    for (bool finished = false; !finished;) {
      const std::function<void()>* work = nullptr;
      std::optional<Report> progress;
      {
        const WithoutGil released;
        work = calling_thread.wait(kPollInterval);
        finished = calling_thread.finished();
        const std::lock_guard lock(mutex);
        std::swap(progress, newest);
      }
      if (work) {
        (*work)();
        calling_thread.answer();
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (progress && !on_progress.is_none()) on_progress(*progress);
    }
  } catch (...) {
    raised = std::current_exception();
    stop = true;
    calling_thread.abandon();
  }
  {
    const WithoutGil released;
    worker.join();
  }
  if (raised) {
    if (result) keep(std::move(*result));
    std::rethrow_exception(raised);
  }
  if (failure) std::rethrow_exception(failure);
  return std::move(*result);
}

// The same for `load()`, which reads files and may simplify meshes; call it with the GIL.
template <typename Load>
auto loadInterruptibly(Load load) {
  using Result = decltype(load());
  const auto run = [&](auto, const std::atomic<bool>& stop, CallingThread&) {
    const SimplificationStop simplification_stop(stop);
    return load();
  };
  return runInterruptibly<Result>(nb::none(), run, [](const Result&) {});
}

}  // namespace taxelsim::python
