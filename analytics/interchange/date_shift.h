// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace calot::analytics {

/// Seconds of 30 to 365 days, earlier or later, from the system's source of randomness.
std::int64_t drawShift();

/// "2026-01-01T00:00:00Z" moved, in whole seconds (parts of one are cut off); empty where that is no such time.
std::string shiftedUtc(const std::string& utc, std::int64_t seconds);

}  // namespace calot::analytics
