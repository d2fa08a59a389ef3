// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that documents of assessment hold.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "recorder/formats/json_reader.h"

namespace calot::analytics {

inline constexpr std::size_t longestName = 64, longestText = 2000;

/// Letters, digits, points, hyphens and underscores: names are printed, and typed.
inline std::string plainName(const recorder::JsonPlace& place) {
  std::string name = place.text(longestName);
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
  if (!plain) place.fail("a name of letters, digits, points, hyphens and underscores is wanted");
  return name;
}

}  // namespace calot::analytics
