// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/guard_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "recorder/recording/guard_answer.h"
#include "recorder/recording/hdf5.h"

namespace calot::recorder {

namespace {

bool sendAll(int to, const void* data, std::size_t bytes) {
  const auto* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t n = ::send(to, at, bytes, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

bool receiveAll(int from, void* data, std::size_t bytes) {
  auto* at = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t n = ::recv(from, at, bytes, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

bool sendText(int to, const std::string& text) {
  const std::uint64_t bytes = text.size();
  return sendAll(to, &bytes, sizeof bytes) && sendAll(to, text.data(), text.size());
}

/// Nothing where the other end was closed.
std::optional<std::string> receiveText(int from) {
  std::uint64_t bytes = 0;
  if (!receiveAll(from, &bytes, sizeof bytes)) return std::nullopt;
  std::string text(static_cast<std::size_t>(bytes), '\0');
  if (!receiveAll(from, text.data(), text.size())) return std::nullopt;
  return text;
}

struct Limits {
  std::int64_t seconds = 0;
  std::uint64_t memory = 0;
};

/// What a guarding process does until its socket is closed.
[[noreturn]] void serve(int socket, const GuardProcesses::Task& task) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // What this process holds open (a pipe to another program, a file's lock) is not to stay open by a copy of it.
  ::close_range(3, static_cast<unsigned>(socket) - 1, 0);
  ::close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
  Limits limits;
  while (receiveAll(socket, &limits, sizeof limits)) {
    const std::optional<std::string> file = receiveText(socket);
    if (!file) break;
    const GuardLimits most{std::chrono::seconds(limits.seconds), static_cast<std::size_t>(limits.memory)};
    const std::string answer = packedAnswer(
        *file,
        [&] {
          return runGuarded(
              *file, [&] { return task(*file); }, most);
        },
        [&](const Where& where) { return Error(ErrorKind::failure, where, "no memory"); });
    if (!sendText(socket, answer)) break;
  }
  ::_exit(0);
}

}  // namespace

GuardProcesses::GuardProcesses(Task task, unsigned count) : task_(std::move(task)) {
  {
    const hdf5::Session session;
    if (H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_FILE) != 0) return;
  }
  for (unsigned i = 0; i < count; ++i) {
    const Process process = begin();
    if (process.id > 0) idle_.push_back(process);
  }
}

GuardProcesses::~GuardProcesses() {
  for (Process& process : idle_) end(process);
}

GuardProcesses::Process GuardProcesses::begin() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return {};
  pid_t child = -1;
  {
    // No other thread is inside HDF5 at the moment of the fork: the child may use it.
    const hdf5::Session quiet;
    child = ::fork();
  }
  if (child == 0) serve(ends[1], task_);
  ::close(ends[1]);
  if (child > 0) return {child, ends[0]};
  ::close(ends[0]);
  return {};
}

void GuardProcesses::end(Process& process) {
  ::close(process.socket);
  while (::waitpid(process.id, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::string GuardProcesses::run(const std::string& file, const GuardLimits& limits) {
  Process process;
  {
    std::unique_lock<std::mutex> held(lock_);
    free_.wait(held, [&] { return !idle_.empty() || busy_ == 0; });
    if (!idle_.empty()) {
      process = idle_.back();
      idle_.pop_back();
      ++busy_;
    }
  }
  std::optional<std::string> answer;
  if (process.id > 0) {
    const Limits most{limits.time.count(), limits.memory};
    if (sendAll(process.socket, &most, sizeof most) && sendText(process.socket, file))
      answer = receiveText(process.socket);
    if (!answer) end(process);
    const std::lock_guard<std::mutex> held(lock_);
    if (answer) idle_.push_back(process);
    --busy_;
    free_.notify_one();
  }
  if (answer) {
    if (std::optional<std::string> result = unpackedAnswer(*answer)) return std::move(*result);
  }
  return runGuarded(
      file, [&] { return task_(file); }, limits);
}

}  // namespace calot::recorder
