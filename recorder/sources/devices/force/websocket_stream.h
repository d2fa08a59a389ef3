// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <memory>
#include <string>

namespace calot::recorder {

/// Client's end of a WebSocket (RFC 6455) that carries text, by Boost.Beast. Never blocks longer than asked; nothing
/// throws: a broken connection is closed, which callers can query.
class WebSocketStream {
 public:
  WebSocketStream();
  ~WebSocketStream();
  WebSocketStream(WebSocketStream&&) noexcept;
  WebSocketStream& operator=(WebSocketStream&&) noexcept;

  /// @returns a stream that is not open where nobody answered within `wait`; `fault` then says why.
  static WebSocketStream connect(const std::string& host, int port, std::chrono::milliseconds wait, std::string& fault);

  [[nodiscard]] bool open() const;
  /// The next message. @returns false where none came within `wait`, or the stream is closed.
  bool receive(std::string& text, std::chrono::nanoseconds wait);
  /// Sends a message; one that waits for the one before it is replaced by a newer one.
  void send(std::string text);
  /// Says good-bye and closes.
  void close();

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace calot::recorder
