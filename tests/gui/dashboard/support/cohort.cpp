// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/dashboard/support/cohort.h"

#include <cstdio>

#include "analytics/checkpoints/registry.h"

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

}  // namespace calot::gui::test
