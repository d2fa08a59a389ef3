// SPDX-License-Identifier: GPL-3.0-or-later
// Child processes: a program, or a copy of this process that runs one task, each at the other end of a connection.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "recorder/base/files.h"

namespace calot::recorder {

/// One end of a connection between two processes; closed with the object. Sending to a process that has ended is an
/// error and no signal.
class Channel {
 public:
  using Deadline = std::chrono::steady_clock::time_point;
  static constexpr Deadline never = Deadline::max();

  explicit Channel(int descriptor = -1) : descriptor_(descriptor) {}

  /// @return false where the other end is closed
  [[nodiscard]] bool send(std::span<const std::byte> bytes) const;
  enum class Received : std::uint8_t { all, ended, late };
  /// Fills all of `bytes`. @param deadline after which it is not waited for any more
  [[nodiscard]] Received receive(std::span<std::byte> bytes, Deadline deadline = never) const;
  /// Appends what comes until the other end is closed (all) or the deadline (late).
  [[nodiscard]] Received receiveRest(std::vector<std::byte>& out, Deadline deadline) const;

  /// Bytes after their number: for two processes that trust each other.
  [[nodiscard]] bool sendMessage(std::span<const std::byte> bytes) const;
  /// @return nothing where the other end is closed
  [[nodiscard]] std::optional<std::vector<std::byte>> receiveMessage() const;

  [[nodiscard]] int descriptor() const { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
};

/// This process's end of a new connection, and the end for a child. @throws Error (failure)
std::pair<Channel, Channel> newConnection();

struct ProcessEnd {
  bool signalled = false;
  int number = 0;  ///< signal, or exit code
  /// "exit code 4", "signal 31 (Bad system call)".
  [[nodiscard]] std::string describe() const;
};

class ChildProcess {
 public:
  /// Starts a program: what is sent is its standard input, its standard output is received. Its standard error goes
  /// nowhere; it has no other open file and no environment.
  /// @param command program and arguments @throws Error (undecided) where it cannot be started
  explicit ChildProcess(const std::vector<std::string>& command);

  /// Runs a task in a copy of this process, which ends when the task returns and when the calling thread does. The copy
  /// has every descriptor of this process and only the calling thread.
  /// @param quiet held while the process is copied, so that no thread is inside what it guards; null: nothing
  /// @throws Error (failure)
  using Task = std::function<void(const Channel& parent)>;
  explicit ChildProcess(const Task& task, std::mutex* quiet = nullptr);

  ChildProcess(ChildProcess&& o) noexcept
      : pid_(std::exchange(o.pid_, -1)), channel_(std::move(o.channel_)), end_(o.end_) {}
  ChildProcess& operator=(ChildProcess&& o) noexcept {
    std::swap(pid_, o.pid_);
    std::swap(channel_, o.channel_);
    std::swap(end_, o.end_);
    return *this;
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// As end().
  ~ChildProcess() { static_cast<void>(end()); }

  [[nodiscard]] const Channel& channel() const { return channel_; }
  [[nodiscard]] pid_t pid() const { return pid_; }  ///< -1: it has ended
  /// Closes the connection and waits for the end; a process that does not end within `patience` is killed.
  ProcessEnd end(std::chrono::milliseconds patience = std::chrono::milliseconds(200));

 private:
  pid_t pid_ = -1;
  Channel channel_;
  ProcessEnd end_;
};

}  // namespace calot::recorder
