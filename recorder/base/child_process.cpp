// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
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

/// Waits until something can be read. @return false at the deadline
bool waitFor(int descriptor, Channel::Deadline deadline) {
  for (;;) {
    int left = -1;
    if (deadline != Channel::never) {
      const auto ms = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
      if (ms <= 0) return false;
      left = static_cast<int>(std::min<long long>(ms, INT_MAX));
    }
    pollfd ready{descriptor, POLLIN, 0};
    const int found = ::poll(&ready, 1, left);
    if (found > 0 || (found < 0 && errno != EINTR)) return true;
  }
}

}  // namespace

bool Channel::send(std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

Channel::Received Channel::receive(std::span<std::byte> bytes, Deadline deadline) const {
  while (!bytes.empty()) {
    if (!waitFor(descriptor(), deadline)) return Received::late;
    const ssize_t n = ::recv(descriptor(), bytes.data(), bytes.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Received::ended;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return Received::all;
}

Channel::Received Channel::receiveRest(std::vector<std::byte>& out, Deadline deadline) const {
  std::array<std::byte, 65536> piece;
  for (;;) {
    if (!waitFor(descriptor(), deadline)) return Received::late;
    const ssize_t n = ::recv(descriptor(), piece.data(), piece.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Received::all;
    out.insert(out.end(), piece.begin(), piece.begin() + n);
  }
}

bool Channel::sendMessage(std::span<const std::byte> bytes) const {
  const std::array<std::uint64_t, 1> size{bytes.size()};
  return send(std::as_bytes(std::span(size))) && send(bytes);
}

std::optional<std::vector<std::byte>> Channel::receiveMessage() const {
  std::array<std::uint64_t, 1> size{};
  if (receive(std::as_writable_bytes(std::span(size))) != Received::all) return std::nullopt;
  std::vector<std::byte> bytes(static_cast<std::size_t>(size.front()));
  if (receive(bytes) != Received::all) return std::nullopt;
  return bytes;
}

std::pair<Channel, Channel> newConnection() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error(ErrorKind::failure, fmt::format("no connection to a child process: {}", std::strerror(errno)));
  return {Channel(ends[0]), Channel(ends[1])};
}

std::string ProcessEnd::describe() const {
  return signalled ? fmt::format("signal {} ({})", number, ::strsignal(number)) : fmt::format("exit code {}", number);
}

ChildProcess::ChildProcess(const std::vector<std::string>& command) {
  auto [own, childs] = newConnection();
  FileActions actions;
  posix_spawn_file_actions_adddup2(actions.get(), childs.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(actions.get(), childs.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(actions.get(), STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(actions.get(), STDERR_FILENO + 1);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  std::array<char*, 1> noEnvironment{nullptr};
  const int failed =
      ::posix_spawnp(&pid_, arguments.front(), actions.get(), nullptr, arguments.data(), noEnvironment.data());
  if (failed != 0) {
    pid_ = -1;
    throw Error(ErrorKind::undecided, Where{command.front()},
                fmt::format("cannot be started: {}", std::strerror(failed)));
  }
  channel_ = std::move(own);
}

ChildProcess::ChildProcess(const Task& task, std::mutex* quiet) {
  auto [own, childs] = newConnection();
  {
    std::unique_lock<std::mutex> held;
    if (quiet != nullptr) held = std::unique_lock<std::mutex>(*quiet);
    pid_ = ::fork();
  }
  if (pid_ == 0) {
    ::close(own.descriptor());
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
      task(childs);
    } catch (...) {
      ::_exit(1);  // never into the callers of the parent
    }
    ::_exit(0);
  }
  if (pid_ < 0) throw Error(ErrorKind::failure, fmt::format("no child process: {}", std::strerror(errno)));
  channel_ = std::move(own);
}

ProcessEnd ChildProcess::end(std::chrono::milliseconds patience) {
  if (pid_ < 0) return end_;
  // It may be ending by itself: its own reason is the better one.
  ::shutdown(channel_.descriptor(), SHUT_RDWR);
  const int process = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  const bool ended = waitFor(process, std::chrono::steady_clock::now() + patience);
  ::close(process);
  if (!ended) ::kill(pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  channel_ = Channel();
  end_ = {WIFSIGNALED(status), WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status)};
  return end_;
}

}  // namespace calot::recorder
