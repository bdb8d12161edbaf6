#include "workers/worker_processes.h"

#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

#include "taxelsim/error.h"

namespace taxelsim::workers {
namespace {

constexpr const char* kThisProgram = "/proc/self/exe";  // also after the file was replaced
constexpr auto kWaitPeriod = std::chrono::milliseconds(100);

// The arguments of this process, with `more` before the "--" that ends its options.
std::vector<std::string> argumentsWith(const std::vector<std::string>& more) {
  std::ifstream stream("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '\0');) words.push_back(word);
  words.insert(std::find(words.begin(), words.end(), "--"), more.begin(), more.end());
  return words;
}

// Returns the process, or throws Error(kIo).
pid_t spawn(std::vector<std::string> words, const Descriptor& input, const Descriptor& output) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_adddup2(&streams, input.number(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, output.number(), STDOUT_FILENO);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t blocked;
  ::sigemptyset(&blocked);
  ::sigaddset(&blocked, SIGINT);
  ::sigaddset(&blocked, SIGTERM);
  ::posix_spawnattr_setsigmask(&attributes, &blocked);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = -1;
  const int code = ::posix_spawn(&child, kThisProgram, &streams, &attributes, argv.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&streams);
  if (code != 0) throw Error(ErrorKind::kIo, std::string("cannot be started: ") + std::strerror(code));
  return child;
}

// How a process ended that did not send kEnd.
std::string endOf(int status) {
  if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status)) + " (" + ::strsignal(WTERMSIG(status)) + ")";
  return "ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

void WorkerProcesses::start(int num_processes) {
  children_.resize(static_cast<std::size_t>(num_processes - 1));
  reports_.resize(children_.size());
  for (std::size_t index = 0; index < children_.size(); ++index) {
    try {
      startOne(index);
    } catch (const std::exception& error) {
      lose(index, error.what());
    }
  }
}

void WorkerProcesses::startOne(std::size_t index) {
  Pipe control = makePipe(), messages = makePipe();
  const std::string role = std::to_string(index + 2) + "/" + std::to_string(children_.size() + 1);
  Child& child = children_[index];
  child.process = spawn(argumentsWith({"--worker", role}), control.read, messages.write);
  child.control = std::move(control.write);
  child.messages = std::move(messages.read);
  try {
    child.reader = std::thread([this, index] { read(index); });
  } catch (const std::system_error&) {
    ::kill(child.process, SIGKILL);
    ::waitpid(child.process, nullptr, 0);
    throw;
  }
}

void WorkerProcesses::read(std::size_t index) {
  WorkerReport& report = reports_[index];
  bool has_ended = false;
  std::string problem;
  while (std::optional<Message> message = receive(children_[index].messages.number())) {
    const std::lock_guard lock(mutex_);
    if (message->kind == MessageKind::kProgress)
      for (const Progress& last : message->values<Progress>()) report.progress = last;
    else if (message->kind == MessageKind::kProblem)
      problem = message->text();
    else if (message->kind == MessageKind::kEnd)
      has_ended = true;
    else
      report.messages.push_back(std::move(*message));
  }
  int status = 0;
  while (::waitpid(children_[index].process, &status, 0) < 0 && errno == EINTR) continue;
  if (!has_ended) return lose(index, problem.empty() ? endOf(status) : problem);
  const std::lock_guard lock(mutex_);
  ++num_ended_;
  ended_.notify_one();
}

void WorkerProcesses::lose(std::size_t index, const std::string& problem) {
  const std::lock_guard lock(mutex_);
  reports_[index] = {.progress = {}, .messages = {}, .problem = problem};
  if (!is_stopping_) spdlog::warn("worker {} of {}: {}; {}", index + 2, children_.size() + 1, problem, consequence_);
  ++num_ended_;
  ended_.notify_one();
}

Progress WorkerProcesses::progress() const {
  const std::lock_guard lock(mutex_);
  Progress sum;
  for (const auto& [progress, messages, problem] : reports_) {
    sum.episodes_done += progress.episodes_done;
    sum.num_episodes += progress.num_episodes;
    sum.frames_done += progress.frames_done;
    sum.num_frames += progress.num_frames;
    sum.episodes_resumed += progress.episodes_resumed;
  }
  return sum;
}

void WorkerProcesses::askToStop() {
  is_stopping_ = true;
  for (Child& child : children_) child.control.close();
}

void WorkerProcesses::join(const std::atomic<bool>* stop, const std::function<void()>& on_wait) {
  std::unique_lock lock(mutex_);
  while (num_ended_ < children_.size()) {
    if (stop != nullptr && *stop) askToStop();
    ended_.wait_for(lock, kWaitPeriod);
    lock.unlock();
    on_wait();
    lock.lock();
  }
  lock.unlock();
  for (Child& child : children_)
    if (child.reader.joinable()) child.reader.join();
}

WorkerProcesses::~WorkerProcesses() {
  {
    const std::lock_guard lock(mutex_);
    askToStop();
  }
  for (Child& child : children_)
    if (child.reader.joinable()) child.reader.join();
}

}  // namespace taxelsim::workers
