// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace calot::page {

/// Bytes that the host has put into the module: calot_place() makes room for them.
std::vector<std::byte>& placed();

}  // namespace calot::page
