// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/pointer_track.h"

#include <utility>

namespace calot::gui {
namespace {

double squared(QPointF p) { return QPointF::dotProduct(p, p); }

}  // namespace

QPointF PointerTrack::moved(QPointF now) {
  const QPointF last = last_.value_or(now);
  last_ = now;
  if (put_ && squared(now - *put_) <= squared(now - last)) return now - *std::exchange(put_, std::nullopt);
  return now - last;
}

}  // namespace calot::gui
