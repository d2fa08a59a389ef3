// SPDX-License-Identifier: GPL-3.0-or-later
// Events of a Linux input device. The kernel's own interface is shorter than a library's set-up, and takes events from
// any stream, which tests without a mouse need. Internal to this folder.
#pragma once

#include <linux/input.h>
#include <unistd.h>
#include <array>
#include <cerrno>

namespace calot::recorder {

/// Calls take(event) for each event that has come; never waits. @returns false where the device is gone
bool readEvents(int descriptor, const auto& take) {
  std::array<input_event, 64> events;
  for (;;) {
    const ssize_t n = ::read(descriptor, events.data(), sizeof events);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
    const std::size_t count = static_cast<std::size_t>(n) / sizeof(input_event);
    for (std::size_t i = 0; i < count; ++i) take(events[i]);
    if (count < events.size()) return true;
  }
}

}  // namespace calot::recorder
