// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "analytics/interchange/cohort_bundle.h"

namespace calot::analytics {

/// manifest.json of a bundle: its content, what was withheld, and how names and dates were changed. @param bundle with
/// all of its files but this one. @param scope to which the participants have consented.
std::string bundleManifest(const Bundle& bundle, const std::string& scope);

}  // namespace calot::analytics
