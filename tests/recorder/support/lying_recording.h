// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings with intact chains whose content the simulation does not give.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "recorder/engine/observer.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::recorder::test {

/// What is written otherwise than it came out, at one step.
struct Lie {
  enum class About {
    force,       ///< of the step's fifth tick
    torque,      ///< of its last tick
    contactSet,  ///< the right hand's first tick names one that is two steps older
    sample,      ///< the left hand of its third tick stood 1 nm elsewhere
    digest,      ///< of the liver's positions
    volume,      ///< of the liver, in its last bits
    event,       ///< one more
    keyframe,    ///< a byte of the State
    lastByte,    ///< of the keyframe
  };
  About about;
  std::uint64_t step;
};

/// 2.1 s of a performer over smallScene(): 210 steps, keyframes after steps 99 and 199.
void recordTouches(const std::filesystem::path& file, const std::optional<Lie>& lie = {});

}  // namespace calot::recorder::test
