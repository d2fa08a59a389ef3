// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/haply_device.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

namespace calot::recorder {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t longestMessage = 1U << 20U;
constexpr std::size_t mostWaiting = 64;  // messages that nobody has asked for; older ones are dropped
constexpr std::chrono::milliseconds goodbye{100};

}  // namespace

struct WebSocketStream::Inside {
  asio::io_context io;
  websocket::stream<tcp::socket> socket{io};
  boost::beast::flat_buffer buffer;
  std::deque<std::string> received;
  std::string sending;
  std::optional<std::string> next;
  bool writing = false;
  bool open = false;

  ~Inside() {
    if (open) {
      io.restart();
      io.run_for(std::chrono::milliseconds(writing ? 20 : 0));
      socket.async_close(websocket::close_code::normal, [](error_code) {});
      io.restart();
      io.run_for(goodbye);
    }
    // Handlers that are under way refer to this: they run out first.
    error_code ignored;
    socket.next_layer().close(ignored);
    io.restart();
    io.run_for(goodbye);
  }

  void read() {
    socket.async_read(buffer, [this](error_code fault, std::size_t) {
      if (fault) {
        open = false;
        return;
      }
      received.push_back(boost::beast::buffers_to_string(buffer.data()));
      if (received.size() > mostWaiting) received.pop_front();
      buffer.clear();
      read();
    });
  }
  void write() {
    if (writing || !next || !open) return;
    sending = std::move(*next);
    next.reset();
    writing = true;
    socket.async_write(asio::buffer(sending), [this](error_code fault, std::size_t) {
      writing = false;
      if (fault)
        open = false;
      else
        write();
    });
  }
};

WebSocketStream WebSocketStream::connect(const std::string& host, int port, std::chrono::milliseconds wait,
                                         std::string& fault) {
  WebSocketStream out;
  auto inside = std::make_shared<Inside>();
  error_code wrong;
  tcp::resolver resolver(inside->io);
  const auto found = resolver.resolve(host, std::to_string(port), wrong);
  const auto giveUp = [&](const error_code& why) {
    fault = why.message();
    return WebSocketStream();
  };
  if (wrong) return giveUp(wrong);
  auto result = std::make_shared<error_code>(asio::error::timed_out);
  const auto run = [&] {
    inside->io.restart();
    inside->io.run_for(wait);
    return *result;
  };
  asio::async_connect(inside->socket.next_layer(), found,
                      [result](error_code e, const tcp::endpoint&) { *result = e; });
  wrong = run();
  if (wrong) return giveUp(wrong);
  inside->socket.next_layer().set_option(tcp::no_delay(true), wrong);
  inside->socket.read_message_max(longestMessage);
  *result = asio::error::timed_out;
  inside->socket.async_handshake(host + ":" + std::to_string(port), "/", [result](error_code e) { *result = e; });
  wrong = run();
  if (wrong) return giveUp(wrong);
  inside->open = true;
  inside->read();
  out.inside_ = std::move(inside);
  return out;
}

bool WebSocketStream::open() const { return inside_ && inside_->open; }

bool WebSocketStream::receive(std::string& text, std::chrono::nanoseconds wait) {
  if (!inside_) return false;
  Inside& in = *inside_;
  if (in.received.empty() && in.open) {
    in.io.restart();
    in.io.poll();
    const auto until = std::chrono::steady_clock::now() + wait;
    while (in.received.empty() && in.open && std::chrono::steady_clock::now() < until) in.io.run_one_until(until);
  }
  if (in.received.empty()) return false;
  text = std::move(in.received.front());
  in.received.pop_front();
  return true;
}

void WebSocketStream::send(std::string text) {
  if (!open()) return;
  inside_->next = std::move(text);
  inside_->write();
  inside_->io.restart();
  inside_->io.poll();
}

}  // namespace calot::recorder
