// SPDX-License-Identifier: GPL-3.0-or-later
// Stream sockets that never block longer than asked and never raise a signal. Internal to this folder.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "recorder/base/files.h"

namespace calot::recorder {

/// A connected stream. Nothing throws: a broken connection is closed, which callers can query.
class TcpStream {
 public:
  TcpStream() = default;
  explicit TcpStream(Descriptor socket) : descriptor_(std::move(socket)) {}

  /// @returns a stream that is not open where nobody answered within `wait`; `fault` then says why.
  static TcpStream connect(const std::string& host, int port, std::chrono::milliseconds wait, std::string& fault);

  [[nodiscard]] bool open() const { return descriptor_.valid(); }
  /// Waits for something to read. @returns false after `wait`.
  [[nodiscard]] bool readable(std::chrono::nanoseconds wait) const;
  /// Reads what has arrived, at most the buffer; 0: nothing now. Closes if the other side has closed.
  std::size_t receive(std::span<std::byte> buffer);
  /// Reads what has arrived, piece by piece, until take(bytes) is false. Bounded, so that a sender that never stops
  /// cannot hold the thread. @returns false where take() was
  bool receiveAll(const auto& take) {
    std::array<std::byte, 65536> buffer;
    for (int i = 0; i < 16; ++i) {
      const std::size_t n = receive(buffer);
      if (n == 0) break;
      if (!take(std::span<const std::byte>(buffer.data(), n))) return false;
    }
    return true;
  }
  /// All or nothing within a second; closes and returns false where that fails.
  bool send(std::span<const std::byte> bytes);
  void close() { descriptor_.close(); }

 private:
  Descriptor descriptor_;
};

/// Listens on this machine alone (127.0.0.1).
class TcpListener {
 public:
  /// @param port 0: any that is free. @throws Error (failure) where the port is taken.
  explicit TcpListener(int port);

  [[nodiscard]] int port() const { return port_; }
  /// Serves one client after the other until `stop`, or with `once` until the first has gone.
  /// @param tell takes a line for each client that comes or goes
  void serve(const std::atomic<bool>& stop, bool once, const std::function<void(const std::string&)>& tell,
             const std::function<void(TcpStream)>& serveOne);

 private:
  Descriptor descriptor_;
  int port_ = 0;
};

}  // namespace calot::recorder
