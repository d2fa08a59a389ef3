// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "recorder/base/errors.h"

namespace calot::apps {

/// One line on stderr for each wrong row of a manifest, of at most twenty. @return the exit code
int refuseRows(const std::vector<Error>& faults);

}  // namespace calot::apps
