#include "workers/worker.h"

#include <poll.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <thread>

#include "base/text.h"
#include "taxelsim/progress.h"

namespace taxelsim::workers {
namespace {

std::atomic<bool> stop_requested{false};

void waitForEndOfInput() {
  std::byte ignored{};
  while (::read(STDIN_FILENO, &ignored, 1) > 0) continue;
  stop_requested = true;
}

void endWithParent() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, 0) > 0) std::_Exit(EXIT_FAILURE);  // it ended before that call, or asked to stop
}

}  // namespace

const std::atomic<bool>* Worker::stop() const {
  return &stop_requested;
}

void Worker::report(const Progress& progress) const {
  sendValues(MessageKind::kProgress, std::span(&progress, 1));
}

void Worker::sendBytes(MessageKind kind, std::span<const std::byte> bytes) const {
  send(STDOUT_FILENO, kind, bytes);
}

int runWorker(const std::function<void(const Worker&)>& work) {
  endWithParent();
  std::thread(waitForEndOfInput).detach();
  const Worker worker;
  std::string problem;
  try {
    work(worker);
    worker.sendBytes(MessageKind::kEnd, {});
    return EXIT_SUCCESS;
  } catch (const std::bad_alloc&) {
    problem = "out of memory";
  } catch (const std::exception& error) {
    problem = messageLine(error.what());
  }
  worker.sendBytes(MessageKind::kProblem, std::as_bytes(std::span(problem)));
  return EXIT_FAILURE;
}

}  // namespace taxelsim::workers
