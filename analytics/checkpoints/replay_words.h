// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences for people about a run and its replay: programs, windows and cohorts share them.
#pragma once

#include <filesystem>
#include <string>

#include "recorder/replay.h"

namespace calot::analytics {

/// "17 of 2000 steps missed a tolerance (solver 3, contact 14, held back 0)"; empty where none did.
std::string wordsFor(const recorder::StepMisses& misses);

/// "step 813: the simulation of 'liver' ran away (...)".
std::string wordsFor(const recorder::Runaway& runaway);

/// "diverged at step 13: hand.right.input position (...)".
std::string wordsFor(const recorder::Divergence& divergence);

/// "the content chain is broken at flush 3 (...)". @pre it is not intact
std::string wordsFor(const recorder::ChainVerdict& chain);

/// Refuses to branch a recording whose content was changed. @throws Error (refused)
void refuseBrokenParent(const std::filesystem::path& parent, const recorder::ChainVerdict& chain);

/// "bit-exact", or what was found instead; one line that does not name the recording.
std::string wordsFor(const recorder::ReplayReport& report);

}  // namespace calot::analytics
