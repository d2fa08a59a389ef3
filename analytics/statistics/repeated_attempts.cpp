// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/repeated_attempts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analytics/statistics/descriptive.h"

namespace calot::analytics {

Expected<std::vector<ParticipantValue>> onePerParticipant(std::span<const RepeatedValue> values, AttemptRule rule) {
  using Result = Expected<std::vector<ParticipantValue>>;
  if (values.empty()) return Result::none("no values");
  std::map<std::size_t, std::vector<RepeatedValue>> attempts;
  std::set<std::pair<std::size_t, double>> orders;
  for (const RepeatedValue& v : values) {
    if (!std::isfinite(v.value) || !std::isfinite(v.order)) return Result::none("a value is not finite");
    if (rule == AttemptRule::first && !orders.insert({v.participant, v.order}).second)
      return Result::none("two attempts of a participant have one order");
    attempts[v.participant].push_back(v);
  }
  std::vector<ParticipantValue> result;
  for (const auto& [participant, list] : attempts) {
    ParticipantValue one{participant, 0.0, list.size()};
    if (rule == AttemptRule::first) {
      one.value = std::min_element(list.begin(), list.end(), [](const RepeatedValue& a, const RepeatedValue& b) {
                    return a.order < b.order;
                  })->value;
    } else {
      std::vector<double> figures;
      for (const RepeatedValue& v : list) figures.push_back(v.value);
      one.value = *mean(figures);
    }
    result.push_back(one);
  }
  return result;
}

}  // namespace calot::analytics
