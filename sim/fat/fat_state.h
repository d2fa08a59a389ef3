// SPDX-License-Identifier: GPL-3.0-or-later
// Everything of a body of fat that changes.
#pragma once

#include "sim/carving/carved_field.h"
#include "sim/solid/solid.h"

namespace calot {

/// Two parts of State, each with its own fields: the motion changes in every step that the fat is awake, the field only
/// where something was carved. All else follows from them and is rebuilt (FatBody::rebuild()).
struct FatState {
  SolidState solid;
  CarvedBricks carved;
};

}  // namespace calot
