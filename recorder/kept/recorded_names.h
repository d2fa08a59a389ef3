// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "recorder/base/identity.h"
#include "sim/scene/model.h"

namespace calot::recorder {

/// Re-simulation computes values, not what they are called: whether a recording's structures, components and fields
/// have the names that its own scene gives them. @return one phrase of the first that has another; or empty
/// @pre the recording is of this program's simulation version
std::string nameFault(const AttemptHeader& header, const Model& model);

/// The same of digests alone, for an engine that is another program.
std::string nameFault(const DigestLayout& recorded, const DigestLayout& engine);

}  // namespace calot::recorder
