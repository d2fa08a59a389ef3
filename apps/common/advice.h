// SPDX-License-Identifier: GPL-3.0-or-later
// Advice of the command line on an error: commands and options.
#pragma once

#include <string>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::apps {

/// "do this, or that".
std::string advice(const std::vector<Remedy>& remedies);

/// "message; do this, or that". @param message one line; without remedies it stays as it is
std::string advised(const std::string& message, const std::vector<Remedy>& remedies);

/// An error's message with its advice.
std::string messageOf(const Error& error);

}  // namespace calot::apps
