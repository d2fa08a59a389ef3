// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "sim/scene/step_result.h"

namespace calot::analytics {

/// Steps at whose end instruments touch or hold some of a scene's vessels.
class VesselContact {
 public:
  /// @param chosen which vessels
  VesselContact(const AttemptContext& context, bool (*chosen)(const SceneFacts::Vessel&));

  void add(const StepResult& result);
  [[nodiscard]] bool anyVessel() const { return !names_.empty(); }
  /// Seconds, summed over instruments and vessels: two at once count twice.
  [[nodiscard]] double sum() const;
  /// Seconds with any instrument on any of the vessels.
  [[nodiscard]] double united() const { return seconds(united_); }
  /// "cystic-duct 0.50 s, cystic-artery 0.25 s": the sum's parts.
  [[nodiscard]] std::string parts() const;

 private:
  [[nodiscard]] double seconds(std::uint64_t steps) const;

  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::vector<std::uint32_t> bit_;    ///< of HandResult::contacts(), one a vessel
  std::vector<std::string> names_;    ///< as many
  std::vector<std::uint64_t> steps_;  ///< as many; over both hands
  std::uint64_t united_ = 0;
};

}  // namespace calot::analytics
