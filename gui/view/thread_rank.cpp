// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/thread_rank.h"

#include <sys/resource.h>
#include <unistd.h>

namespace calot::gui {

void stepBack(int behind) {
  // Linux keeps a nice value for each thread, and passes it on to those the thread starts; a larger one needs no
  // privilege. Of a program that runs behind others as a whole, the same distance again.
  const int program = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::getpid()));
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), program + behind);
}

}  // namespace calot::gui
