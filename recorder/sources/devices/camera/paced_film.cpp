// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/paced_film.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace calot::recorder {

FrameStatus PacedFilm::next(std::chrono::nanoseconds wait, Frame& out) {
  if (begin_ < 0) begin_ = clock_();
  std::uint64_t dropped = 0;
  for (;;) {
    if (!held_) {
      const FrameStatus status = film_->next(std::chrono::nanoseconds(0), pending_);
      if (status != FrameStatus::frame) return status;
      held_ = true;
    }
    const std::int64_t due = begin_ + pending_.time;
    if (clock_() < due && wait.count() > 0)
      std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(due - clock_())));
    const std::int64_t now = clock_();
    if (now < due) return FrameStatus::none;
    held_ = false;
    if (now < due + 2 * period_) {
      out = std::move(pending_);
      out.time = due;
      out.missed += dropped;
      return FrameStatus::frame;
    }
    dropped += 1 + pending_.missed;
  }
}

}  // namespace calot::recorder
