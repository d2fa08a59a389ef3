// SPDX-License-Identifier: GPL-3.0-or-later
// What a command line or a table says of a motion file, as words.
#pragma once

#include <string>
#include <string_view>

#include "analytics/import_motion.h"

namespace calot::analytics {

/// Sets one field of a declaration from its word: "task", "participant", "mode", "purpose", "handedness", "outcome" or
/// "start". An empty word leaves the field as it is.
/// @return empty, or what is wanted instead; then nothing is set
/// @pre `field` is one of these.
std::string declareMotion(MotionDeclaration& declaration, std::string_view field, const std::string& word);

}  // namespace calot::analytics
