// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/placed_attempts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "analytics/report/study_population.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

/// By participant, by start.
std::map<std::string, std::vector<const AttemptRow*>> attemptsByPerson(DesignData& data,
                                                                       const std::vector<const AttemptRow*>& taken,
                                                                       const StudyOptions& options,
                                                                       const DesignChoices& choices,
                                                                       const std::string& name) {
  std::map<std::string, std::vector<const AttemptRow*>> people;
  const bool byDevice = choices.design == Design::agreement && choices.against.empty();
  for (const AttemptRow* a : taken) people[unitOf(*a)].push_back(a);
  std::uint64_t later = 0;
  std::size_t several = 0;
  std::string whose;
  for (auto& [person, list] : people) {
    std::stable_sort(list.begin(), list.end(),
                     [](const AttemptRow* a, const AttemptRow* b) { return a->startUtc < b->startUtc; });
    for (const AttemptRow* a : list) {
      if (!data.groups.empty() && groupOf(*a, options.grouping) != groupOf(*list[0], options.grouping))
        throw Error(ErrorKind::refused, Where{name},
                    fmt::format("participant \"{}\" is in two groups, which must be independent", person));
    }
    if (!entryOf(choices.design).oneEach) continue;
    std::set<std::string> seen;
    std::vector<const AttemptRow*> first;
    for (const AttemptRow* a : list) {
      if (seen.insert(byDevice ? a->device : std::string()).second) first.push_back(a);
    }
    if (first.size() == list.size()) continue;
    if (several++ == 0) whose = fmt::format("\"{}\" has {}", person, list.size());
    if (choices.attemptRule != AttemptRule::first) continue;
    later += list.size() - first.size();
    list = first;
  }
  if (several > 0 && !choices.attemptRule) {
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("participant {} attempts{} ({} participant{} with several), which are not independent",
                            whose, byDevice ? ", of a device more than one" : "", several, several == 1 ? "" : "s"),
                {Remedy::chooseAttemptRule});
  }
  data.attemptRule = several == 0 ? (entryOf(choices.design).oneEach ? "one attempt each" : "all attempts of each")
                     : choices.attemptRule == AttemptRule::first ? "the first of a participant's attempts"
                                                                 : "the mean of a participant's attempts";
  if (later > 0) data.flow.push_back({"later attempt of a participant (the first counts)", later});
  return people;
}

void place(DesignData& data, const std::map<std::string, std::vector<const AttemptRow*>>& people,
           const StudyOptions& options, const DesignChoices& choices, PlacedAttempts& placed) {
  const bool byDevice = choices.design == Design::agreement && choices.against.empty();
  data.occasionWord = byDevice ? "device" : "attempt";
  data.numbered = !byDevice;
  std::set<std::string> strata, devices;
  std::size_t most = 0;
  for (const auto& [person, list] : people) {
    if (!choices.strata.empty()) strata.insert(stratumOf(*list[0], choices.strata));
    for (const AttemptRow* a : list) devices.insert(a->device);
    most = std::max(most, list.size());
  }
  data.strata.assign(strata.begin(), strata.end());
  if (byDevice) data.occasions.assign(devices.begin(), devices.end());
  for (std::size_t i = 0; !byDevice && i < most; ++i) data.occasions.push_back(fmt::format("{}", i + 1));
  for (const auto& [person, list] : people) {
    DesignPerson p{person, 0, 0};
    if (!data.groups.empty()) p.group = positionIn(data.groups, groupOf(*list[0], options.grouping));
    if (!choices.strata.empty()) p.stratum = positionIn(data.strata, stratumOf(*list[0], choices.strata));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const AttemptRow& a = *list[i];
      placed[a.uuid] = {data.people.size(), byDevice ? positionIn(data.occasions, a.device) : i,
                        static_cast<double>(i + 1), a.outcome == recorder::Outcome::completed,
                        static_cast<double>(a.steps) * a.stepSeconds};
      data.attempts.push_back(a.uuid);
      data.synthetic = data.synthetic || a.synthetic;
      ++data.analysed;
    }
    data.people.push_back(std::move(p));
  }
}

}  // namespace

std::size_t positionIn(std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

std::string stratumOf(const AttemptRow& a, const std::string& strata) { return strata == "arm" ? a.arm : a.site; }

PlacedAttempts placeAttempts(DesignData& data, const std::vector<const AttemptRow*>& taken, const StudyOptions& options,
                             const DesignChoices& choices, const std::string& name) {
  PlacedAttempts placed;
  place(data, attemptsByPerson(data, taken, options, choices, name), options, choices, placed);
  return placed;
}

}  // namespace calot::analytics
