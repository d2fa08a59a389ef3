// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace calot::apps {

/// From the first line of `file`, where one is named; else from the environment (CALOT_KEY_PASSPHRASE); else typed on
/// the terminal, unseen. @throws Error (invalid) where there is none of them.
std::string readPassphrase(const std::string& file);

}  // namespace calot::apps
