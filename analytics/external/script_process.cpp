// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/external/script_process.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <system_error>

#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t maxAnswer = 65536;
constexpr int answerDescriptor = 3;
constexpr int notStarted = 127;

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(ErrorKind::failure, std::string("pipe: ") + std::generic_category().message(errno));
    read = ends[0];
    write = ends[1];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    ::close(read);
    closeWrite();
  }
  void closeWrite() {
    if (write >= 0) ::close(write);
    write = -1;
  }
};

/// Children of this program.
std::set<pid_t> childrenNow() {
  std::set<pid_t> children;
  DIR* const tasks = opendir("/proc/self/task");
  if (tasks == nullptr) return children;
  while (const dirent* task = readdir(tasks)) {
    if (task->d_name[0] == '.') continue;
    std::ifstream list(fmt::format("/proc/self/task/{}/children", task->d_name));
    for (pid_t child = 0; list >> child;) children.insert(child);
  }
  closedir(tasks);
  return children;
}

/// While it lives, what a child leaves behind becomes this program's child, so that it can be ended even where it has
/// left the child's process group.
class Adoption {
 public:
  Adoption() : before_(childrenNow()) {
    prctl(PR_GET_CHILD_SUBREAPER, &was_);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
  }
  Adoption(const Adoption&) = delete;
  Adoption& operator=(const Adoption&) = delete;
  ~Adoption() {
    // Ending one hands its own children over: until none is new.
    for (int pass = 0; pass < 100; ++pass) {
      bool any = false;
      for (const pid_t child : childrenNow()) {
        if (before_.count(child) > 0) continue;
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        any = true;
      }
      if (!any) break;
    }
    prctl(PR_SET_CHILD_SUBREAPER, was_);
  }

 private:
  std::set<pid_t> before_;
  int was_ = 0;
};

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  static_cast<void>(setrlimit(static_cast<__rlimit_resource>(resource), &both));
}

/// In the child, after fork: calls nothing that another thread of the parent may have locked.
[[noreturn]] void become(char* const* arguments, char* const* environment, const char* folder, int answer, int printed,
                         const ScriptLimits& limits, std::uint64_t inputBytes) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = open("/dev/null", O_RDONLY);
  // The answer's end may be one of the numbers that are given out here.
  const int kept = fcntl(answer, F_DUPFD, 10);
  const int shown = fcntl(printed, F_DUPFD, 10);
  if (nothing < 0 || kept < 0 || shown < 0 || chdir(folder) != 0) _exit(notStarted);
  dup2(nothing, STDIN_FILENO);
  dup2(shown, STDOUT_FILENO);
  dup2(shown, STDERR_FILENO);
  dup2(kept, answerDescriptor);
  close_range(answerDescriptor + 1, ~0U, 0);
  limit(RLIMIT_AS, static_cast<rlim_t>(limits.mebibytes) * 1048576U + static_cast<rlim_t>(inputBytes));
  limit(RLIMIT_CPU, limits.seconds + 1);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_NPROC, 0);
  execve(arguments[0], arguments, environment);
  _exit(notStarted);
}

/// @return whether there may be more.
bool readSome(int descriptor, std::string& into, std::size_t most, bool& over) {
  std::array<char, 4096> piece{};
  const ssize_t n = read(descriptor, piece.data(), piece.size());
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  if (n == 0) return false;
  const std::size_t taken = std::min(static_cast<std::size_t>(n), most - into.size());
  into.append(piece.data(), taken);
  over = over || taken < static_cast<std::size_t>(n);
  return true;
}

/// It has ended and is not reaped yet, so that its number is nobody else's.
bool hasEnded(pid_t child) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
}

std::vector<char*> pointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

std::string pythonProgram() {
  if (const char* named = std::getenv("CALOT_PYTHON"); named != nullptr && *named != '\0') return named;
  const std::string system = "/usr/bin/python3";
  if (access(system.c_str(), X_OK) == 0) return system;
  const char* const path = std::getenv("PATH");
  std::string rest = path != nullptr ? path : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string program = rest.substr(0, colon) + "/python3";
    if (access(program.c_str(), X_OK) == 0) return program;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return system;
}

ScriptEnd runScript(const std::vector<std::string>& command, const std::filesystem::path& folder,
                    const ScriptLimits& limits, std::uint64_t inputBytes) {
  if (access(command.front().c_str(), X_OK) != 0)
    throw Error(ErrorKind::failure, Where{command.front()},
                fmt::format("cannot be started: {}; CALOT_PYTHON names the Python that runs metrics",
                            std::generic_category().message(errno)));
  const std::string home = folder.string();
  // One thread: sums have one order.
  const std::vector<std::string> fixed{"PATH=/usr/bin:/bin", "HOME=" + home,      "TMPDIR=" + home,
                                       "LANG=C.UTF-8",       "PYTHONHASHSEED=0",  "OPENBLAS_NUM_THREADS=1",
                                       "OMP_NUM_THREADS=1",  "MKL_NUM_THREADS=1", "PYTHONDONTWRITEBYTECODE=1"};
  const std::vector<char*> arguments = pointersTo(command), environment = pointersTo(fixed);
  Pipe answer, printed;
  const Adoption adoption;
  const auto deadline = Clock::now() + std::chrono::seconds(limits.seconds);
  const pid_t child = fork();
  if (child < 0)
    throw Error(ErrorKind::failure, Where{command.front()},
                "cannot be started: " + std::generic_category().message(errno));
  if (child == 0)
    become(arguments.data(), environment.data(), home.c_str(), answer.write, printed.write, limits, inputBytes);
  setpgid(child, child);  // whichever of both comes first
  answer.closeWrite();
  printed.closeWrite();
  ScriptEnd end;
  std::array<pollfd, 2> ready{pollfd{answer.read, POLLIN, 0}, pollfd{printed.read, POLLIN, 0}};
  bool over = false, ended = false, killed = false;
  for (const int descriptor : {answer.read, printed.read}) fcntl(descriptor, F_SETFL, O_NONBLOCK);
  while (!ended) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    // What it forked may keep both pipes open after its end.
    const bool open = ready[0].fd >= 0 || ready[1].fd >= 0;
    poll(ready.data(), ready.size(), static_cast<int>(std::clamp<long long>(left, 1, open ? 50 : 1)));
    ended = hasEnded(child);
    std::array<std::string*, 2> into{&end.answer, &end.printed};
    for (std::size_t i = 0; i < ready.size(); ++i) {
      if (ready[i].fd < 0 || ready[i].revents == 0) continue;
      if (!readSome(ready[i].fd, *into[i], i == 0 ? maxAnswer : maxPrinted, over)) ready[i].fd = -1;
    }
    if (ended || killed) continue;
    if (left <= 0) end.how = ScriptEnd::How::late;
    if (over) end.how = ScriptEnd::How::printedTooMuch;
    if (left <= 0 || over) {
      kill(-child, SIGKILL);
      killed = true;
    }
  }
  kill(-child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  for (std::size_t i = 0; i < ready.size(); ++i) {
    const int descriptor = i == 0 ? answer.read : printed.read;
    std::string& into = i == 0 ? end.answer : end.printed;
    const std::size_t most = i == 0 ? maxAnswer : maxPrinted;
    for (std::size_t before = into.size() + 1; before != into.size() && into.size() < most;) {
      before = into.size();
      static_cast<void>(readSome(descriptor, into, most, over));
    }
  }
  if (killed) return end;
  if (over) {
    end.how = ScriptEnd::How::printedTooMuch;
  } else if (WIFSIGNALED(status)) {
    end.how = WTERMSIG(status) == SIGXCPU ? ScriptEnd::How::late : ScriptEnd::How::signalled;
    end.number = WTERMSIG(status);
  } else {
    end.number = WEXITSTATUS(status);
  }
  if (end.number == notStarted && end.answer.empty() && end.how == ScriptEnd::How::exited)
    throw Error(ErrorKind::failure, Where{command.front()},
                "cannot be started; CALOT_PYTHON names the Python that runs metrics");
  return end;
}

}  // namespace calot::analytics
