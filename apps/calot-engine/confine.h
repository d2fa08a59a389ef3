// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/engine/engine.h"

namespace calot::apps {

/// Memory that an engine may have: a whole operation takes 0.2 GB.
inline constexpr unsigned long long engineMemory = 4ULL << 30U;

/// Gives up all that a program may do but read and write what is open, have memory, and end: from here on anything else
/// ends it (seccomp). Bounds its memory; leaves it no file to open and no process to start.
recorder::Confinement confine();

}  // namespace calot::apps
