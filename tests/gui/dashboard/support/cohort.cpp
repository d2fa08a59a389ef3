// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/dashboard/support/cohort.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::gui::test {

analytics::AttemptRecord attemptNumber(int i) {
  analytics::AttemptRecord attempt;
  char uuid[40];
  std::snprintf(uuid, sizeof uuid, "%08x-0000-4000-8000-%012x", static_cast<unsigned>(0x1000 + i),
                static_cast<unsigned>(i));
  attempt.uuid = uuid;
  attempt.scene = "touch-liver";
  attempt.sceneMajor = 1;
  attempt.operatorKind = recorder::OperatorKind::performer;
  attempt.profile = i % 2 == 0 ? "skilled" : "unskilled";
  attempt.profileVersion = std::string("1");
  attempt.synthetic = true;
  attempt.purpose = "demo";
  attempt.outcome = recorder::Outcome::completed;
  char start[32];
  std::snprintf(start, sizeof start, "2026-03-%02dT10:%02d:00Z", 1 + i % 28, i % 60);
  attempt.startUtc = start;
  attempt.simulationVersion = 1;
  attempt.comparabilityKey = "touch-liver/1 device=- calibration=- simulation=1 results=1 mode=practice";
  attempt.fileName = "recording.h5";
  attempt.complete = true;
  attempt.steps = 1000;
  attempt.verification = {analytics::Verdict::verified, "", "calot 0.1.0"};
  return attempt;
}

analytics::CheckpointValue pathLength(const std::string& hand, double metres) {
  return analytics::makeValue(*analytics::findCheckpoint("path-length"), hand, analytics::Origin::samples, metres);
}

void makeLargeCohort(const std::string& path, int attempts) {
  constexpr int people = 200;
  constexpr std::size_t figures = 40;
  analytics::CohortDatabase database(path, analytics::CohortDatabase::Access::create);
  const auto pseudonym = [](int i) { return "P" + std::to_string(1000 + i % people); };
  for (int i = 0; i < people; ++i) {
    analytics::Participant person;
    person.pseudonym = pseudonym(i);
    person.group = i % 2 == 0 ? "expert" : "novice";
    database.addParticipant(person);
  }
  std::uint32_t state = 1;  // of a congruential generator
  const auto next = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / static_cast<double>(1U << 24U);
  };
  const auto& registry = analytics::checkpointRegistry();
  for (int i = 0; i < attempts; ++i) {
    analytics::AttemptRecord attempt = attemptNumber(i);
    attempt.operatorKind = recorder::OperatorKind::human;
    attempt.profile.clear();
    attempt.profileVersion.clear();
    attempt.synthetic = false;
    attempt.participant = pseudonym(i);
    attempt.startUtc = fmt::format("20{:02}-{:02}-{:02}T{:02}:{:02}:{:02}Z", 10 + i / 1000, 1 + i / 84 % 12,
                                   1 + i / 3 % 28, i % 24, i % 60, i / 24 % 60);
    std::vector<analytics::CheckpointValue> values;
    values.reserve(figures);
    for (std::size_t f = 0; f < std::min(figures, registry.size()); ++f) {
      const double value = 1.0 + 0.3 * (i % 2) + next();
      const bool count = registry[f].definition.domain == analytics::Domain::whole;
      values.push_back(analytics::makeValue(registry[f].definition, "", analytics::Origin::observables,
                                            count ? std::floor(value) : value));
    }
    database.storeAttempt(attempt, values);
  }
}

}  // namespace calot::gui::test
