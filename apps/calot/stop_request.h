// SPDX-License-Identifier: GPL-3.0-or-later
// Ending a run in good order: what SIGINT and SIGTERM ask for.
#pragma once

#include <atomic>

namespace calot::apps {

/// From here on both signals ask to stop instead of ending the program.
void stopOnSignals();

/// Was it asked? The program itself may ask, too.
std::atomic<bool>& stopRequested();

}  // namespace calot::apps
