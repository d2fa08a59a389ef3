// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/receive_message.h"

#include <fmt/format.h>

#include <array>

namespace calot::recorder {

std::string receiveMessage(ChildProcess& child, MessageHead& head, wire::Bytes& payload) {
  const auto deadline = std::chrono::steady_clock::now() + enginePatience;
  std::array<std::byte, messageHead> bytes{};
  using Received = ChildProcess::Received;
  Received received = child.receive(bytes, deadline);
  if (received == Received::all) {
    head = parseHead(bytes);
    if (head.length > maxPayload) return "answers with no message";
    payload.resize(static_cast<std::size_t>(head.length));
    received = child.receive(payload, deadline);
  }
  if (received == Received::late) return fmt::format("gave no answer in {} s", enginePatience.count());
  if (received == Received::ended) return "ended: " + child.end();
  return "";
}

}  // namespace calot::recorder
