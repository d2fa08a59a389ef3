// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

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

std::string comparabilityWords(const std::string& key) {
  constexpr std::array<std::string_view, 5> marks{" device=", " calibration=", " simulation=", " results=", " mode="};
  std::array<std::string, marks.size()> part;
  std::string rest = key;
  // From the end: a device's name is free text.
  for (std::size_t i = marks.size(); i-- > 0;) {
    const std::size_t at = rest.rfind(marks[i]);
    if (at == std::string::npos) return key;
    part[i] = rest.substr(at + marks[i].size());
    rest.resize(at);
  }
  const std::size_t slash = rest.rfind('/');
  if (slash == std::string::npos) return key;
  const std::string major = rest.substr(slash + 1);
  const std::string simulation = part[2] == "0" ? "imported motion without simulation"
                                                : fmt::format("simulation {}, step results {}", part[2], part[3]);
  return fmt::format("task {}{}, device {}, {}, {}, mode {}", rest.substr(0, slash), major == "0" ? "" : " " + major,
                     part[0], part[1] == "-" ? "no calibration" : "calibration " + part[1], simulation, part[4]);
}

}  // namespace calot::analytics
