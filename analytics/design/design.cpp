// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/design.h"

#include <algorithm>
#include <array>

namespace calot::analytics {
namespace {

constexpr std::array<DesignEntry, 9> allDesigns{{
    {Design::twoGroups, "two-groups", "Do two groups differ", "Mann-Whitney, A, shift", GroupsNeeded::two, true},
    {Design::severalGroups, "groups", "Do three or more groups differ", "Kruskal-Wallis, Dunn's pairs",
     GroupsNeeded::several, true},
    {Design::strata, "strata", "Do two groups differ within sites", "van Elteren", GroupsNeeded::two, true},
    {Design::repeated, "repeated", "Do two groups change differently over their attempts",
     "mixed model of group and occasion", GroupsNeeded::two, false},
    {Design::timeToCriterion, "time-to-criterion", "Who finishes sooner, unfinished attempts included",
     "log-rank, Kaplan-Meier", GroupsNeeded::two, true},
    {Design::learning, "learning", "How fast do groups learn, and who has reached the criterion",
     "curves, attempts to criterion", GroupsNeeded::any, false},
    {Design::correlation, "correlation", "Do figures go with another, such as a rating", "Spearman", GroupsNeeded::none,
     true},
    {Design::agreement, "agreement", "Do two devices or methods measure the same", "Bland-Altman, Deming",
     GroupsNeeded::none, true},
    {Design::reliability, "reliability", "How far are figures repeatable over raters or attempts",
     "variance components, D-study, SEM, SDC", GroupsNeeded::none, false},
}};

}  // namespace

std::span<const DesignEntry> designs() { return allDesigns; }

const DesignEntry& entryOf(Design design) { return allDesigns[static_cast<std::size_t>(design)]; }

std::optional<Design> designOf(std::string_view name) {
  const auto at =
      std::find_if(allDesigns.begin(), allDesigns.end(), [&](const DesignEntry& e) { return e.name == name; });
  return at == allDesigns.end() ? std::nullopt : std::optional(at->design);
}

}  // namespace calot::analytics
