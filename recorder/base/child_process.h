// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace calot::recorder {

/// A program of which this one has both ends: what is sent is its standard input, its standard output is received. Its
/// standard error goes nowhere, and it has no other open file.
class ChildProcess {
 public:
  /// @param command program and arguments @throws Error (undecided) where it cannot be started
  explicit ChildProcess(const std::vector<std::string>& command);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it where it has not ended.
  ~ChildProcess();

  /// @return false where it has ended
  [[nodiscard]] bool send(std::span<const std::byte> bytes);
  enum class Received : std::uint8_t { all, ended, late };
  /// Fills all of `bytes`. @param deadline after which it is not waited for any more
  [[nodiscard]] Received receive(std::span<std::byte> bytes, std::chrono::steady_clock::time_point deadline);
  /// How it ended: "exit code 4", "signal 31 (Bad system call)". Kills it where it has not.
  [[nodiscard]] std::string end();

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
  std::string ended_;
};

}  // namespace calot::recorder
