// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort's attempts and values as a design needs them.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "analytics/design/cohort_figures.h"
#include "analytics/design/design_data.h"
#include "analytics/design/placed_attempts.h"
#include "analytics/report/study_population.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

std::string leftOutOf(const DesignData& data) {
  std::string left;
  for (const FlowRow& row : data.flow)
    left += fmt::format("{}{} {}", left.empty() ? "" : ", ", row.attempts, row.reason);
  return fmt::format(" of {} attempts{}", data.recruited, left.empty() ? "" : " (left out: " + left + ")");
}

DesignData populated(const std::vector<AttemptRow>& recruited, const std::vector<AttemptValue>& values,
                     const StudyOptions& options, const DesignChoices& choices, const std::string& name,
                     PlacedAttempts& placed) {
  DesignData data;
  data.source = "cohort";
  data.counted = "attempts";
  data.where = std::filesystem::path(name).filename().string();
  const bool grouped = entryOf(choices.design).groups != GroupsNeeded::none || !choices.groups.empty();
  std::map<std::string, std::uint64_t> out, present;
  std::vector<const AttemptRow*> taken;
  std::uint64_t withoutStratum = 0;
  StudyOptions rules = options;
  if (!grouped) rules.grouping = Grouping::group;
  for (const AttemptRow& a : recruited) {
    ++data.recruited;
    AttemptRow judged = a;
    if (!grouped) judged.group = "everybody";  // having none excludes nobody here
    if (const std::string reason = whyOut(judged, rules); !reason.empty()) {
      ++out[reason];
    } else if (!choices.strata.empty() && stratumOf(a, choices.strata).empty()) {
      ++withoutStratum;
    } else {
      ++present[groupOf(a, options.grouping)];
      taken.push_back(&a);
    }
  }
  data.flow = flowOf(out);
  if (withoutStratum > 0) data.flow.push_back({"no " + choices.strata, withoutStratum});
  if (grouped) {
    data.groups = groupsOfDesign(present, choices, name, leftOutOf(data));
    const auto all = taken.size();
    taken.erase(std::remove_if(taken.begin(), taken.end(),
                               [&](const AttemptRow* a) {
                                 return std::find(data.groups.begin(), data.groups.end(),
                                                  groupOf(*a, options.grouping)) == data.groups.end();
                               }),
                taken.end());
    if (taken.size() < all) data.flow.push_back({"another group", all - taken.size()});
  }
  if (data.groups.size() == 2) data.better = betterOf({data.groups[0], data.groups[1]}, choices);
  std::set<std::string> keys;
  StudySetting setting;
  for (const AttemptRow* a : taken) {
    keys.insert(a->comparabilityKey);
    addToSetting(setting, *a);
  }
  const std::vector<std::string> keyList(keys.begin(), keys.end());
  askForOneKey(keyList, options, name, data.remarks);
  placed = placeAttempts(data, taken, options, choices, name);
  for (const std::string& key : keyList) {
    std::string words = comparabilityWords(key);
    if (!words.empty() && words[0] == 't') words[0] = 'T';
    data.head.push_back(words + ".");
  }
  const std::string first = setting.firstStartUtc.substr(0, 10), last = setting.lastStartUtc.substr(0, 10);
  data.head.push_back(first.empty()
                          ? "The dates of the attempts are not known."
                          : fmt::format("Attempts from {} to {}. Cohort {}{}.", first, last, data.where,
                                        options.cohort ? ", participants of \"" + options.cohort->name + "\"" : ""));
  addFigures(data, values, placed, options, choices, name);
  if (choices.design == Design::timeToCriterion) keepTimes(data, values, placed);
  return data;
}

}  // namespace

DesignData cohortDesignData(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                            const StudyOptions& options, const DesignChoices& choices, const std::string& name) {
  PlacedAttempts placed;
  DesignData data = populated(attempts, values, options, choices, name, placed);
  keepNamedFigures(data, choices);
  return data;
}

DesignData cohortDesignData(const CohortDatabase& database, const AssessmentDatabase& assessment,
                            const StudyOptions& asked, const DesignChoices& choices) {
  StudyOptions options = asked;
  options.family = choices.family;
  if (options.cohort) options.cohort->participants = participantsOf(database.path(), options.cohort->name);
  PlacedAttempts placed;
  DesignData data = populated(database.listAttempts(), database.allValues(unaskedPhases(options)), options, choices,
                              database.path(), placed);
  if (choices.design != Design::timeToCriterion) {
    const std::vector<Rating> ratings = assessment.ratings();
    for (const StoredDocument& stored : assessment.forms()) {
      const auto* bytes = reinterpret_cast<const std::byte*>(stored.text.data());
      const RatingForm form = parseRatingForm({bytes, stored.text.size()}, stored.name);
      if (form.ofAttempts) addForm(data, form, ratings, placed);
    }
  }
  keepNamedFigures(data, choices);
  return data;
}

}  // namespace calot::analytics
