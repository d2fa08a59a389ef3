// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/math/record.h"

namespace calot::recorder {

/// How well an assistant holds the endoscope. Part of a performer's profile.
struct ScopeSkill {
  double reaction = 0.35;      ///< from one look at the picture to the next (s)
  double deadZone = 0.4;       ///< how far the work may leave the picture's centre (halves of the picture's height)
  double horizonError = 0.03;  ///< root mean square of the camera head's rotation from level (rad)

  static std::vector<Field> fields();
};

}  // namespace calot::recorder
