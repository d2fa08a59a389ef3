// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analytics/cohort/cohort_database.h"

#include "recorder/words.h"

namespace calot::analytics {

std::string comparabilityKey(const recorder::AttemptHeader& header) {
  const auto orDash = [](const std::string& s) { return s.empty() ? std::string("-") : s; };
  // Without a device, the kind of operator takes its place: a performer's hands are not a human's.
  const std::string device =
      header.provenance.device.empty() ? wordFor(header.provenance.kind) : header.provenance.device;
  return fmt::format("{}/{} device={} calibration={} simulation={} results={} mode={}", header.sceneName,
                     header.sceneMajor, device, orDash(header.provenance.calibration), header.simulationVersion,
                     header.stepResultVersion, wordFor(header.mode));
}

}  // namespace calot::analytics
