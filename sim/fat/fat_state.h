// SPDX-License-Identifier: GPL-3.0-or-later
// State of a body of fat.
#pragma once

#include "sim/carving/carved_field.h"
#include "sim/solid/solid.h"

namespace calot {

/// Two parts of State with separate fields: motion changes in every step in which the fat is awake, the field only when
/// something is carved. Everything else is derived from them (FatBody::rebuild()).
struct FatState {
  SolidState solid;
  CarvedBricks carved;
};

}  // namespace calot
