// SPDX-License-Identifier: GPL-3.0-or-later
// The one list of instruments. Each has a definition of this name in namespace instrument (sim/instruments) and a
// drawing of this name (gui/render): a missing one does not link. docs/extending/index.md says how to add
// one.
#pragma once

/// Name in code, and the number that recordings store, which is never reused. In the order of the trainer's keys.
#define CALOT_INSTRUMENTS(ENTRY) \
  ENTRY(grasper, 1)              \
  ENTRY(hook, 2)                 \
  ENTRY(clipApplier, 3)          \
  ENTRY(scissors, 4)             \
  ENTRY(probe, 5)
