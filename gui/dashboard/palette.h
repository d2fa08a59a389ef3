// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of charts and timelines: Okabe and Ito's set, told apart by people with any of the common colour-vision
// deficiencies. Sign, shape or word carries every meaning beside them.
#pragma once

#include <QColor>

#include "sim/judgement/judge.h"

namespace calot::gui::palette {

inline const QColor blue(0x00, 0x72, 0xb2);
inline const QColor vermillion(0xd5, 0x5e, 0x00);
inline const QColor skyBlue(0x56, 0xb4, 0xe9);
inline const QColor orange(0xe6, 0x9f, 0x00);
inline const QColor grey(0xb8, 0xb8, 0xb8);
inline const QColor darkText(0x22, 0x22, 0x22);
inline const QColor mutedText(0x50, 0x50, 0x50);

inline QColor ofPhase(Phase phase) {
  switch (phase) {
    case Phase::identification:
      return skyBlue;
    case Phase::clipping:
      return orange;
    case Phase::cutting:
      return QColor(0xf0, 0xe4, 0x42);
    case Phase::dissection:
      return QColor(0x7f, 0xd0, 0xb8);
    case Phase::none:
    case Phase::done:
      return QColor(0xd8, 0xd8, 0xd8);
  }
  return grey;
}

}  // namespace calot::gui::palette
