// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/guarded.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/recording/guard_answer.h"
#include "recorder/recording/hdf5.h"

namespace calot::recorder {

namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

/// Lets this process have so many bytes more than it has now.
void limitMemory(std::size_t bytes) {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages == 0) return;
  const rlim_t most = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit{most, most};
  ::setrlimit(RLIMIT_AS, &limit);
}

Error tooLarge(const Where& where, const GuardLimits& limits) {
  return {ErrorKind::damaged, where,
          fmt::format("reading it needs more than {} MiB of memory; the file is damaged or not a recording",
                      limits.memory / mebibyte)};
}

/// Runs the task and sends what came of it.
[[noreturn]] void runChild(int out, const std::string& what, const std::function<std::string()>& task,
                           const GuardLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  limitMemory(limits.memory);
  const std::string message = packedAnswer(what, task, [&](const Where& where) { return tooLarge(where, limits); });
  for (std::size_t at = 0; at < message.size();) {
    const ssize_t n = ::write(out, message.data() + at, message.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    at += static_cast<std::size_t>(n);
  }
  ::_exit(0);
}

/// Reads until the child closes its end. @return false when the time is over.
bool readAll(int in, std::chrono::steady_clock::time_point end, std::string& out) {
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
    if (left <= 0) return false;
    pollfd p{in, POLLIN, 0};
    const int ready = ::poll(&p, 1, static_cast<int>(std::min<long long>(left, 1'000'000)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) continue;
    std::array<char, 65536> buffer;
    const ssize_t n = ::read(in, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    out.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

GuardLimits readingLimits(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  GuardLimits limits;
  limits.time = std::chrono::seconds(60 + (error ? 0 : std::min<std::uintmax_t>(bytes / mebibyte, 3600)));
  return limits;
}

std::string runGuarded(const std::string& what, const std::function<std::string()>& task, const GuardLimits& limits) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0)
    throw Error(ErrorKind::failure, Where{what}, fmt::format("no pipe: {}", std::strerror(errno)));
  pid_t child = -1;
  {
    // No other thread is inside HDF5 at the moment of the fork: the child may use it.
    const std::unique_lock<std::mutex> quiet(hdf5::processLock());
    child = ::fork();
  }
  if (child == 0) {
    ::close(pipe[0]);
    runChild(pipe[1], what, task, limits);
  }
  ::close(pipe[1]);
  if (child < 0) {
    ::close(pipe[0]);
    throw Error(ErrorKind::failure, Where{what}, fmt::format("no child process: {}", std::strerror(errno)));
  }
  std::string message;
  const bool inTime = readAll(pipe[0], std::chrono::steady_clock::now() + limits.time, message);
  ::close(pipe[0]);
  if (!inTime) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!inTime) {
    throw Error(
        ErrorKind::damaged, Where{what},
        fmt::format("reading it took longer than {} s; the file is damaged or not a recording", limits.time.count()));
  }
  if (WIFEXITED(status)) {
    if (std::optional<std::string> answer = unpackedAnswer(message)) return std::move(*answer);
  }
  throw Error(ErrorKind::damaged, Where{what},
              fmt::format("the reading library failed on it (signal {}); the file is damaged or not a recording",
                          WIFSIGNALED(status) ? WTERMSIG(status) : 0));
}

}  // namespace calot::recorder
