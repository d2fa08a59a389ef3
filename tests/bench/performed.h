// SPDX-License-Identifier: GPL-3.0-or-later
// What a performer did in a scene, to be run open-loop elsewhere.
#pragma once

#include <string>

#include "tests/bench/touch_motion.h"

namespace calot::bench {

/// Samples of the skilled performer, seed 1, in a shipped scene, until it is done or `seconds` of attempt time are
/// over.
Motion performed(const std::string& scene, double seconds);

}  // namespace calot::bench
