// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>

#include "recorder/base/errors.h"

namespace calot::recorder {

namespace {

/// Actions of a spawned process on its files; freed at the end.
class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command) {
  std::array<int, 2> ends{};
  // A socket and not two pipes: writing to a program that has ended is then an error and no signal.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error(ErrorKind::failure, Where{command.front()}, std::strerror(errno));
  FileActions actions;
  posix_spawn_file_actions_adddup2(actions.get(), ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(actions.get(), ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(actions.get(), STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(actions.get(), STDERR_FILENO + 1);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  std::array<char*, 1> noEnvironment{nullptr};
  const int failed =
      posix_spawnp(&pid_, arguments.front(), actions.get(), nullptr, arguments.data(), noEnvironment.data());
  close(ends[1]);
  socket_ = ends[0];
  if (failed == 0) return;
  pid_ = -1;
  close(socket_);
  throw Error(ErrorKind::undecided, Where{command.front()},
              fmt::format("cannot be started: {}", std::strerror(failed)));
}

ChildProcess::~ChildProcess() {
  static_cast<void>(end());
  close(socket_);
}

bool ChildProcess::send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

ChildProcess::Received ChildProcess::receive(std::span<std::byte> bytes,
                                             std::chrono::steady_clock::time_point deadline) {
  while (!bytes.empty()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0) return Received::late;
    pollfd ready{socket_, POLLIN, 0};
    const int found = poll(&ready, 1, static_cast<int>(std::min<long long>(left, INT_MAX)));
    if (found < 0 && errno != EINTR) return Received::ended;
    if (found <= 0) continue;
    const ssize_t n = recv(socket_, bytes.data(), bytes.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Received::ended;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Received::all;
}

std::string ChildProcess::end() {
  if (pid_ < 0) return ended_;
  // It may be ending by itself: its own reason is the better one.
  constexpr std::chrono::milliseconds patience{200};
  const auto until = std::chrono::steady_clock::now() + patience;
  shutdown(socket_, SHUT_RDWR);
  int status = 0;
  pid_t reaped = 0;
  while ((reaped = waitpid(pid_, &status, WNOHANG)) == 0 && std::chrono::steady_clock::now() < until) usleep(500);
  if (reaped == 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, &status, 0);
  }
  pid_ = -1;
  ended_ = WIFSIGNALED(status) ? fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
                               : fmt::format("exit code {}", WEXITSTATUS(status));
  return ended_;
}

}  // namespace calot::recorder
