// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/key_fault.h"

#include <fmt/format.h>

#include <optional>

#include "analytics/cohort/registers.h"

namespace calot::apps {

std::string keyFaultOf(const analytics::AttemptRecord& attempt, const std::string& cohort) {
  if (attempt.station.empty()) return {};
  std::optional<analytics::PublicKey> key;
  if (attempt.signature) key = attempt.signature->publicKey;
  switch (analytics::standingOf(analytics::readRegisters(cohort), attempt.station, key)) {
    case analytics::KeyStanding::another:
      return fmt::format("signed by another key than that of station {} in {}", attempt.station, cohort);
    case analytics::KeyStanding::unsignedButExpected:
      return fmt::format("not signed, though station {} has a key in {}", attempt.station, cohort);
    default:
      return {};
  }
}

}  // namespace calot::apps
