// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

#include "recorder/base/child_process.h"
#include "recorder/engine/messages.h"

namespace calot::recorder {

/// How long an engine may take over one answer. A step takes milliseconds, the largest scene seconds.
inline constexpr std::chrono::seconds enginePatience{120};

/// Takes an engine's next message. @returns why there is none: "ended: exit code 7"; empty where there is one
std::string receiveMessage(ChildProcess& child, MessageHead& head, wire::Bytes& payload);

}  // namespace calot::recorder
