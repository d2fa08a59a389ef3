// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/picture_scale.h"

#include <cmath>

namespace calot::gui {

void PictureScale::take(std::size_t level) {
  level_ = level;
  sum_ = 0.0;
  count_ = 0;
}

void PictureScale::drew(double side, double seconds) {
  if (rate_ <= 0.0 || side != sides[level_]) return;
  sum_ += seconds;
  if (++count_ < enough) return;
  const double possible = drawers_ * count_ / sum_;
  if (possible < rate_ && level_ + 1 < sides.size()) {
    // At least as far as would do if all of the cost went with the pixels.
    const double most = sides[level_] * std::sqrt(possible / rate_);
    std::size_t level = level_ + 1;
    while (level + 1 < sides.size() && sides[level] > most) ++level;
    return take(level);
  }
  if (level_ > 0) {
    const double growth = sides[level_ - 1] / sides[level_];
    if (possible > spare * rate_ * growth * growth) return take(level_ - 1);
  }
  take(level_);
}

}  // namespace calot::gui
