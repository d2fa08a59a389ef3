// SPDX-License-Identifier: GPL-3.0-or-later
// Which two groups a study compares, and which of them is expected to do better.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "analytics/report/study.h"

namespace calot::analytics {

/// Names of groups: levels of skill first, best first; others behind them, by name.
bool groupBefore(const std::string& a, const std::string& b);

/// The two groups to compare.
/// @param present units by group; @param left what the error says of those that stay out, or empty
/// @throws Error (invalid) for names that are not two different ones, Error (refused) where there are not two groups.
std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyChoices& choices, const std::string& path, const std::string& left);

/// The group that is expected to do better, or empty. @throws Error (invalid) where `choices.better` is none of the
/// two.
std::string betterOf(const std::array<std::string, 2>& groups, const StudyChoices& choices);

}  // namespace calot::analytics
