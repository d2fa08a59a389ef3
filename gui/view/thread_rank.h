// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace calot::gui {

/// Nice values relative to the program's: a thread with the second gets about a ninth of the share of GUI and
/// simulation threads, one with the first four tenths.
inline constexpr int behindInterface = 4;    ///< reading, replays, imports, which a user waits for
inline constexpr int behindEverything = 10;  ///< pictures: a late one is replaced by the next

/// Lowers the priority of the calling thread, and of those it starts later, relative to the program's other threads:
/// rendering and reading wait for GUI and simulation, never the other way round. No effect on an idle processor. May be
/// called between fork and exec.
inline void stepBack(int behind) {
  // Linux keeps a nice value for each thread, and passes it on to those the thread starts; a larger one needs no
  // privilege. Of a program that runs behind others as a whole, the same distance again.
  const int program = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::getpid()));
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), program + behind);
}

}  // namespace calot::gui
