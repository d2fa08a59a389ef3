// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/tcp.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

constexpr std::chrono::milliseconds maxSend{1000};
constexpr std::chrono::milliseconds lookPeriod{50};  // between two looks at `stop`

bool waitFor(int descriptor, short what, std::chrono::nanoseconds wait) {
  pollfd p{descriptor, what, 0};
  const auto whole = std::max<std::int64_t>(0, wait.count());
  const timespec t{static_cast<time_t>(whole / 1'000'000'000), static_cast<long>(whole % 1'000'000'000)};
  return ppoll(&p, 1, &t, nullptr) > 0;
}

void sendAtOnce(const Descriptor& socket) {
  const int on = 1;
  setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

Descriptor tryAddress(const addrinfo& a, std::chrono::milliseconds wait, int& fault) {
  Descriptor d(socket(a.ai_family, a.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a.ai_protocol));
  fault = d.valid() && connect(d.get(), a.ai_addr, a.ai_addrlen) == 0 ? 0 : errno;
  if (d.valid() && fault == EINPROGRESS) {
    socklen_t length = sizeof fault;
    if (!waitFor(d.get(), POLLOUT, wait)) {
      fault = ETIMEDOUT;
    } else if (getsockopt(d.get(), SOL_SOCKET, SO_ERROR, &fault, &length) < 0) {
      fault = errno;
    }
  }
  if (fault != 0) return Descriptor();
  sendAtOnce(d);
  return d;
}

}  // namespace

TcpStream TcpStream::connect(const std::string& host, int port, std::chrono::milliseconds wait, std::string& fault) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int found = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (found != 0) {
    fault = gai_strerror(found);
    return {};
  }
  int number = 0;
  TcpStream stream;
  for (const addrinfo* a = list; a != nullptr && !stream.open(); a = a->ai_next)
    stream = TcpStream(tryAddress(*a, wait, number));
  freeaddrinfo(list);
  if (!stream.open()) fault = std::strerror(number);
  return stream;
}

bool TcpStream::readable(std::chrono::nanoseconds wait) const {
  return open() && waitFor(descriptor_.get(), POLLIN, wait);
}

std::size_t TcpStream::receive(std::span<std::byte> buffer) {
  if (!open() || buffer.empty()) return 0;
  const ssize_t n = recv(descriptor_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (n > 0) return static_cast<std::size_t>(n);
  if (n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) close();
  return 0;
}

bool TcpStream::send(std::span<const std::byte> bytes) {
  while (open() && !bytes.empty()) {
    const ssize_t n = ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      if (!waitFor(descriptor_.get(), POLLOUT, maxSend)) close();
    } else if (n < 0 && errno == EINTR) {
      continue;
    } else {
      close();
    }
  }
  return open();
}

TcpListener::TcpListener(int port) : descriptor_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const int on = 1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t length = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (!descriptor_.valid() || setsockopt(descriptor_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) < 0 ||
      bind(descriptor_.get(), generic, length) < 0 || listen(descriptor_.get(), 4) < 0 ||
      getsockname(descriptor_.get(), generic, &length) < 0) {
    throw Error(ErrorKind::failure,
                fmt::format("port {}: {}; give another one, or 0 for any", port, std::strerror(errno)));
  }
  port_ = ntohs(address.sin_port);
}

void TcpListener::serve(const std::atomic<bool>& stop, bool once, const std::function<void(const std::string&)>& tell,
                        const std::function<void(TcpStream)>& serveOne) {
  while (!stop) {
    if (!waitFor(descriptor_.get(), POLLIN, lookPeriod)) continue;
    Descriptor client(accept4(descriptor_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!client.valid()) continue;
    sendAtOnce(client);
    tell("a client is there");
    serveOne(TcpStream(std::move(client)));
    tell("the client is gone");
    if (once) return;
  }
}

}  // namespace calot::recorder
