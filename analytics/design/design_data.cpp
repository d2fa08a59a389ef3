// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/design/design_data.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "analytics/report/study_population.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

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

namespace {

std::string commaList(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + recorder::shown(name);
  return text.empty() ? "none" : text;
}

/// A figure is named by its whole name or by its checkpoint's.
bool isFigure(const DesignFigure& figure, const std::string& name) {
  return figure.name == name || (figure.name.rfind(name + " ", 0) == 0 && figure.name.rfind("rating ", 0) != 0);
}

}  // namespace

std::vector<std::string> groupsOfDesign(const std::map<std::string, std::uint64_t>& present,
                                        const DesignChoices& choices, const std::string& path,
                                        const std::string& left) {
  const DesignEntry& entry = entryOf(choices.design);
  std::vector<std::string> there;
  there.reserve(present.size());
  for (const auto& item : present) there.push_back(item.first);
  std::sort(there.begin(), there.end(), groupBefore);
  for (const std::string& name : choices.groups) {
    if (std::count(choices.groups.begin(), choices.groups.end(), name) > 1)
      throw Error(ErrorKind::invalid, fmt::format("study: group \"{}\" is named twice", recorder::shown(name)));
    if (present.count(name) == 0) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("nothing for the study in group \"{}\" (there are: {}){}", recorder::shown(name),
                              commaList(there), left));
    }
  }
  std::vector<std::string> groups = choices.groups;
  if (groups.empty() && entry.groups != GroupsNeeded::none) groups = there;
  const bool fits = entry.groups == GroupsNeeded::two       ? groups.size() == 2
                    : entry.groups == GroupsNeeded::several ? groups.size() >= 3
                    : entry.groups == GroupsNeeded::any     ? !groups.empty()
                                                            : true;
  if (fits) return groups;
  const char* needed = entry.groups == GroupsNeeded::two       ? "two groups"
                       : entry.groups == GroupsNeeded::several ? "three or more groups"
                                                               : "a group";
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("the design \"{}\" needs {}; there are {} ({}){}", entry.name, needed, groups.size(),
                          commaList(groups), left),
              groups.size() > 2 ? std::initializer_list<Remedy>{Remedy::nameGroups} : std::initializer_list<Remedy>{});
}

void keepNamedFigures(DesignData& data, const DesignChoices& choices) {
  std::vector<std::string> wanted = choices.family;
  if (!choices.against.empty()) wanted.push_back(choices.against);
  std::vector<std::string> there;
  for (const DesignFigure& f : data.figures) there.push_back(f.name);
  for (const std::string& name : wanted) {
    if (std::none_of(data.figures.begin(), data.figures.end(), [&](const auto& f) { return isFigure(f, name); })) {
      throw Error(ErrorKind::invalid, Where{data.where},
                  fmt::format("there is no figure \"{}\"{} (there are: {})", recorder::shown(name),
                              recorder::didYouMean(name, there), commaList(there)));
    }
  }
  if (choices.family.empty()) return;
  data.figures.erase(std::remove_if(data.figures.begin(), data.figures.end(),
                                    [&](const DesignFigure& f) {
                                      return std::none_of(wanted.begin(), wanted.end(),
                                                          [&](const std::string& name) { return isFigure(f, name); });
                                    }),
                     data.figures.end());
}

void sortValues(DesignFigure& figure) {
  std::stable_sort(figure.values.begin(), figure.values.end(), [](const DesignValue& a, const DesignValue& b) {
    return a.person != b.person ? a.person < b.person : a.order < b.order;
  });
}

OneEach oneEachOf(const DesignFigure& figure) {
  OneEach result;
  std::vector<RepeatedValue> values;
  for (const DesignValue& v : figure.values) values.push_back({v.person, v.order, v.value});
  const Expected<std::vector<ParticipantValue>> each = onePerParticipant(values, AttemptRule::mean);
  if (!each) return result;
  for (const ParticipantValue& p : *each) {
    result.person.push_back(p.participant);
    result.value.push_back(p.value);
  }
  return result;
}

std::vector<std::vector<double>> byGroup(const DesignData& data, const OneEach& values) {
  std::vector<std::vector<double>> groups(std::max<std::size_t>(data.groups.size(), 1));
  for (std::size_t i = 0; i < values.person.size(); ++i)
    groups[data.people[values.person[i]].group].push_back(values.value[i]);
  return groups;
}

}  // namespace calot::analytics
