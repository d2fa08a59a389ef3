// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/picture_rate.h"

#include <algorithm>

namespace calot::gui {

void PictureRate::setRunning(bool running) {
  running_ = running;
  if (!running_) last_.reset();
}

void PictureRate::shown(Time now) {
  if (!running_) return;
  if (last_) {
    const double wait = std::chrono::duration<double>(now - *last_).count();
    ++pictures_;
    seconds_ += wait;
    longest_ = std::max(longest_, wait);
  }
  last_ = now;
}

}  // namespace calot::gui
