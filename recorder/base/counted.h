// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>

namespace calot::recorder {

/// "1 fault", "2 faults". @param more of several, where that is not `one` and an s
template <std::integral Count>
std::string counted(Count count, std::string_view one, std::string_view more = {}) {
  if (count == 1) return fmt::format("1 {}", one);
  return more.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, more);
}

}  // namespace calot::recorder
