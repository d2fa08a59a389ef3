// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/probe.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "recorder/recording/file_reader.h"

namespace calot::recorder {

namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

/// Outcome of a task, as sent: its result or the error that it threw.
struct Answer {
  std::uint8_t failed = 0;
  std::string result;
  ErrorKind kind = ErrorKind::failure;
  std::string file, place, fault;
  std::vector<Remedy> remedies;

  Answer() = default;
  explicit Answer(const Error& e)
      : failed(1),
        kind(e.kind()),
        file(e.where().file),
        place(e.where().place),
        fault(e.fault()),
        remedies(e.remedies()) {}
  static void fields(auto& self, auto& visit) {
    visit("failed", self.failed);
    visit("result", self.result);
    visit("kind", self.kind);
    visit("file", self.file);
    visit("place", self.place);
    visit("fault", self.fault);
    visit("remedies", self.remedies);
  }
};

/// Runs the task. @param noMemory makes the error of a task that memory was lacking for
std::string answerOf(const std::string& what, const std::function<std::string()>& task,
                     const std::function<Error(const Where&)>& noMemory) {
  // The reading library says in words of its own that it had no memory.
  const auto isOfMemory = [](const Error& e) {
    return e.fault().find("memory allocation failed") != std::string::npos;
  };
  try {
    Answer answer;
    answer.result = task();
    return packed(answer);
  } catch (const Error& e) {
    return packed(Answer(isOfMemory(e) ? noMemory(e.where()) : e));
  } catch (const std::bad_alloc&) {
    return packed(Answer(noMemory(Where{what})));
  } catch (const std::length_error&) {
    return packed(Answer(noMemory(Where{what})));
  } catch (const std::exception& e) {
    return packed(Answer(Error(ErrorKind::failure, e.what())));
  }
}

/// @return nothing where these bytes are no answer @throws Error the one in the answer
std::optional<std::string> resultOf(const std::vector<std::byte>& bytes) {
  Answer answer;
  if (!unpack({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, answer)) return std::nullopt;
  if (answer.failed == 0) return std::move(answer.result);
  if (answer.kind > ErrorKind::undecided) return std::nullopt;
  throw Error(answer.kind, Where{answer.file, answer.place}, answer.fault, std::move(answer.remedies));
}

/// Limits this process to that much of the processor's time, to that many bytes more than it has now, and to no image
/// of its memory.
void limitProcess(std::chrono::seconds time, std::size_t bytes) {
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  const auto seconds = static_cast<rlim_t>(time.count());
  const rlimit processor{seconds, seconds + 5};
  ::setrlimit(RLIMIT_CPU, &processor);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages == 0) return;
  const rlim_t most = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit{most, most};
  ::setrlimit(RLIMIT_AS, &limit);
}

struct Request {
  std::int64_t seconds = 0, wall = 0;
  std::uint64_t memory = 0;
  std::string file;
  static void fields(auto& self, auto& visit) {
    visit("seconds", self.seconds);
    visit("wall", self.wall);
    visit("memory", self.memory);
    visit("file", self.file);
  }
};

/// Main loop of a guarding process, until its parent closes the connection.
void serve(const Channel& parent, const GuardProcesses::Task& task) {
  // Descriptors of this process (a pipe to another program, a file's lock) must not stay open in a copy of it.
  const auto own = static_cast<unsigned>(parent.descriptor());
  ::close_range(3, own - 1, 0);
  ::close_range(own + 1, ~0U, 0);
  Request request;
  while (const auto bytes = parent.receiveMessage()) {
    if (!unpack({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, request)) return;
    const GuardLimits limits{std::chrono::seconds(request.seconds), static_cast<std::size_t>(request.memory),
                             std::chrono::seconds(request.wall)};
    const std::string answer = answerOf(
        request.file,
        [&] {
          return runGuarded(
              request.file, [&] { return task(request.file); }, limits);
        },
        [](const Where& where) { return Error(ErrorKind::failure, where, "no memory"); });
    if (!parent.sendMessage(std::as_bytes(std::span(answer)))) return;
  }
}

constexpr char usableCopy = '+';               ///< of a copy of this process that can read
constexpr std::chrono::seconds untilReady(5);  ///< for it to say so
constexpr int maxCopies = 6;

std::string readThrough(const std::string& file) {
  Recording recording(file);
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) recording.step(n);
  return packed(recording.verifyChain());
}

std::string readBeginning(const std::string& file) {
  Recording recording(file);
  static_cast<void>(recording.events());
  if (recording.stepCount() > 0) recording.step(0);
  return {};
}

/// The processes of this program for each task, while there are some.
struct Shared {
  std::mutex lock;
  std::map<ProbeTask, std::shared_ptr<GuardProcesses>> processes;
};

Shared& shared() {
  static Shared one;
  return one;
}

}  // namespace

GuardLimits readingLimits(const std::filesystem::path& file) {
  GuardLimits limits;
  limits.time = std::chrono::seconds(60 + std::min<std::uint64_t>(sizeOfFile(file) / mebibyte, 3600));
  limits.wall = 20 * limits.time;
  return limits;
}

std::string runGuarded(const std::string& what, const std::function<std::string()>& task, const GuardLimits& limits) {
  const auto tooLarge = [&](const Where& where) {
    return Error(ErrorKind::damaged, where,
                 fmt::format("reading it needs more than {} MiB of memory; the file is damaged or not a recording",
                             limits.memory / mebibyte));
  };
  const auto work = [&](const Channel& parent) {
    limitProcess(limits.time, limits.memory);
    {
      const hdf5::Session usable;  // or this process waits for ever, and is given up
    }
    if (!parent.send(std::as_bytes(std::span(&usableCopy, 1)))) return;
    const std::string answer = answerOf(what, task, tooLarge);
    static_cast<void>(parent.send(std::as_bytes(std::span(answer))));
  };
  std::optional<ChildProcess> copied;
  for (int tries = 1; !copied; ++tries) {
    // No thread is in a Session while the process is copied: the child may use HDF5. A thread that was inside the
    // library all the same leaves its lock to a child that nobody will ever unlock it for: another copy is made.
    copied.emplace(work, &hdf5::processLock());
    char first = 0;
    const auto began = copied->channel().receive(std::as_writable_bytes(std::span(&first, 1)),
                                                 std::chrono::steady_clock::now() + untilReady);
    if (began != Channel::Received::late || tries == maxCopies) break;
    copied->end(std::chrono::milliseconds(0));
    copied.reset();
  }
  ChildProcess& child = *copied;
  std::vector<std::byte> answer;
  const auto received = child.channel().receiveRest(answer, std::chrono::steady_clock::now() + limits.wall);
  if (received == Channel::Received::late) {
    child.end(std::chrono::milliseconds(0));
    throw Error(ErrorKind::failure, Where{what},
                fmt::format("was not read within {} s: is its disk busy, or the machine?", limits.wall.count()));
  }
  const ProcessEnd end = child.end(std::chrono::seconds(5));  // unmapping what it read takes a while
  if (!end.signalled) {
    if (std::optional<std::string> result = resultOf(answer)) return std::move(*result);
  }
  if (end.signalled && end.number == SIGXCPU)
    throw Error(ErrorKind::damaged, Where{what},
                fmt::format("reading it took more than {} s of the processor; the file is damaged or not a recording",
                            limits.time.count()));
  throw Error(ErrorKind::damaged, Where{what},
              fmt::format("the reading library failed on it (signal {}); the file is damaged or not a recording",
                          end.signalled ? end.number : 0));
}

GuardProcesses::GuardProcesses(Task task, unsigned count) : task_(std::move(task)) {
  {
    const hdf5::Session session;
    if (H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_FILE) != 0) return;
  }
  for (unsigned i = 0; i < count; ++i) {
    try {
      idle_.emplace_back([this](const Channel& parent) { serve(parent, task_); }, &hdf5::processLock());
    } catch (const Error&) {
      return;  // fewer, or none: run() does without
    }
  }
}

std::string GuardProcesses::run(const std::string& file, const GuardLimits& limits) {
  std::optional<ChildProcess> process;
  {
    std::unique_lock<std::mutex> held(lock_);
    free_.wait(held, [&] { return !idle_.empty() || busy_ == 0; });
    if (!idle_.empty()) {
      process = std::move(idle_.back());
      idle_.pop_back();
      ++busy_;
    }
  }
  if (process) {
    const std::string request = packed(Request{limits.time.count(), limits.wall.count(), limits.memory, file});
    std::optional<std::vector<std::byte>> answer;
    if (process->channel().sendMessage(std::as_bytes(std::span(request)))) answer = process->channel().receiveMessage();
    {
      const std::lock_guard<std::mutex> held(lock_);
      if (answer) idle_.push_back(std::move(*process));
      --busy_;
      free_.notify_one();
    }
    if (answer) {
      if (std::optional<std::string> result = resultOf(*answer)) return std::move(*result);
    }
  }
  return runGuarded(
      file, [&] { return task_(file); }, limits);
}

std::string runProbe(ProbeTask task, const std::filesystem::path& path, const GuardLimits& limits) {
  std::shared_ptr<GuardProcesses> processes;
  {
    const std::lock_guard<std::mutex> held(shared().lock);
    if (const auto found = shared().processes.find(task); found != shared().processes.end()) processes = found->second;
  }
  const std::string file = path.string();
  if (processes) return processes->run(file, limits);
  return runGuarded(
      file, [&] { return task(file); }, limits);
}

ChainVerdict probe(const std::filesystem::path& path) {
  ChainVerdict verdict;
  if (!unpack(runProbe(readThrough, path, readingLimits(path)), verdict))
    throw Error(ErrorKind::damaged, Where{path.string()}, "the reading library failed on it; the file is damaged");
  return verdict;
}

void probeBeginning(const std::filesystem::path& path) {
  static_cast<void>(runProbe(readBeginning, path, readingLimits(path)));
}

ProbeProcesses::ProbeProcesses(unsigned count, bool window) {
  const std::lock_guard<std::mutex> held(shared().lock);
  first_ = shared().processes.empty();
  if (!first_) return;
  const unsigned each = count == 0 ? std::thread::hardware_concurrency() : count;
  for (const ProbeTask task : {&readThrough, &readBeginning, &readIdentity})
    if (window || task == &readThrough) shared().processes[task] = std::make_shared<GuardProcesses>(task, each);
}

ProbeProcesses::~ProbeProcesses() {
  if (!first_) return;
  const std::lock_guard<std::mutex> held(shared().lock);
  shared().processes.clear();
}

}  // namespace calot::recorder
