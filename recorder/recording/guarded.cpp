// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/guarded.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "recorder/errors.h"
#include "recorder/recording/hdf5.h"

namespace calot::recorder {

namespace {

constexpr char ok = 'r', refused = 'e';

/// Runs the task and sends its outcome: a letter, for an error its exit code as a letter, then the text.
[[noreturn]] void runChild(int out, const std::function<std::string()>& task) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit noCore{0, 0};
  ::setrlimit(RLIMIT_CORE, &noCore);
  std::string message;
  try {
    message = ok + task();
  } catch (const Error& e) {
    message = std::string{refused, static_cast<char>('0' + static_cast<int>(e.code()))} + e.what();
  } catch (const std::exception& e) {
    message = std::string{refused, static_cast<char>('0' + static_cast<int>(ExitCode::failure))} + e.what();
  }
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

std::string runGuarded(const std::string& what, const std::function<std::string()>& task, std::chrono::seconds limit) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0)
    throw Error(ExitCode::failure, fmt::format("{}: no pipe: {}", what, std::strerror(errno)));
  pid_t child = -1;
  {
    // No other thread is inside HDF5 at the moment of the fork: the child may use it.
    const std::unique_lock<std::mutex> quiet(hdf5::processLock());
    child = ::fork();
  }
  if (child == 0) {
    ::close(pipe[0]);
    runChild(pipe[1], task);
  }
  ::close(pipe[1]);
  if (child < 0) {
    ::close(pipe[0]);
    throw Error(ExitCode::failure, fmt::format("{}: no child process: {}", what, std::strerror(errno)));
  }
  std::string message;
  const bool inTime = readAll(pipe[0], std::chrono::steady_clock::now() + limit, message);
  ::close(pipe[0]);
  if (!inTime) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!inTime) {
    throw Error(ExitCode::damaged,
                fmt::format("{}: reading it took longer than {} s; the file is damaged or not a recording", what,
                            limit.count()));
  }
  if (!WIFEXITED(status) || message.empty()) {
    throw Error(ExitCode::damaged,
                fmt::format("{}: the reading library failed on it (signal {}); the file is damaged or not a recording",
                            what, WIFSIGNALED(status) ? WTERMSIG(status) : 0));
  }
  if (message[0] == refused && message.size() >= 2)
    throw Error(static_cast<ExitCode>(message[1] - '0'), message.substr(2));
  return message.substr(1);
}

}  // namespace calot::recorder
