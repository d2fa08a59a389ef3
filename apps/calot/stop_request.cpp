// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/stop_request.h"

#include <csignal>

namespace calot::apps {

namespace {
std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal's handler may do no more
}  // namespace

void stopOnSignals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { requested = true; });
}

std::atomic<bool>& stopRequested() { return requested; }

}  // namespace calot::apps
