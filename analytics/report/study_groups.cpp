// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t notALevel = 3;

/// 0: expert, skilled; 1: intermediate; 2: novice, unskilled.
std::size_t levelOf(const std::string& group) {
  if (group == "expert" || group == "skilled") return 0;
  if (group == "intermediate") return 1;
  return group == "novice" || group == "unskilled" ? 2 : notALevel;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

bool groupBefore(const std::string& a, const std::string& b) {
  const auto rank = [](const std::string& s) {
    static const std::vector<std::string> known{"expert", "skilled", "intermediate", "novice", "unskilled"};
    return std::find(known.begin(), known.end(), s) - known.begin();
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a < b;
}

std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyChoices& choices, const std::string& path, const std::string& left) {
  std::vector<std::string> names;
  names.reserve(present.size());
  for (const auto& item : present) names.push_back(item.first);
  std::sort(names.begin(), names.end(), groupBefore);
  if (!choices.groups.empty()) {
    if (choices.groups.size() != 2 || choices.groups[0] == choices.groups[1]) {
      throw Error(ErrorKind::invalid, "study: its groups are two, with different names", {Remedy::nameGroups});
    }
    for (const std::string& name : choices.groups) {
      if (present.count(name) == 0) {
        throw Error(ErrorKind::refused, Where{path},
                    fmt::format("nothing for the study in group \"{}\" (there are: {}){}", name,
                                names.empty() ? "none" : listed(names), left));
      }
    }
    return {choices.groups[0], choices.groups[1]};
  }
  if (names.size() == 2) return {names[0], names[1]};
  if (names.size() > 2) {
    throw Error(ErrorKind::refused, Where{path}, fmt::format("{} groups ({})", names.size(), listed(names)),
                {Remedy::nameGroups});
  }
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("a study needs two groups, {}{}",
                          names.empty() ? "none is left" : "only " + names[0] + " is there", left));
}

std::string betterOf(const std::array<std::string, 2>& groups, const StudyChoices& choices) {
  if (!choices.better.empty()) {
    if (choices.better != groups[0] && choices.better != groups[1]) {
      throw Error(ErrorKind::invalid,
                  fmt::format("study: the better group is to be \"{}\", but the groups are {} and {}", choices.better,
                              groups[0], groups[1]),
                  {Remedy::nameBetterGroup});
    }
    return choices.better;
  }
  const std::size_t a = levelOf(groups[0]), b = levelOf(groups[1]);
  if (a == notALevel || b == notALevel || a == b) return {};
  return a < b ? groups[0] : groups[1];
}

}  // namespace calot::analytics
