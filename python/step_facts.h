// SPDX-License-Identifier: GPL-3.0-or-later
// Result of a step, kept beyond the step as plain bytes: arrays of numpy look at them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/engine/wire.h"
#include "sim/judgement/judge.h"
#include "sim/scene/model.h"

namespace calot::python {

using Bytes = std::vector<std::byte>;

struct StepFacts {
  std::uint64_t step = 0;
  Bytes observation;  ///< f8: what a controller sees (observedParts)
  Bytes row;          ///< of every column of /observables (recorder::resultColumns)
  Bytes forces;       ///< per tick and hand: force and torque as they were computed, six f8
  Bytes events;       ///< packed, with what was judged (recorder::packedEvents)
  Bytes digest;       ///< u8 of each component of the State; none where another program computed it
  std::uint8_t phase = 0;
  std::uint8_t criticalView = 0;  ///< of six points
  std::uint32_t errors = 0, criticalErrors = 0;
};

/// A part of the observation: for both hands, or one number.
struct ObservedPart {
  const char* name;
  const char* unit;
  std::size_t width;  ///< numbers a hand; 0: one number; structureWidth: one a structure
};
inline constexpr std::size_t structureWidth = static_cast<std::size_t>(-1);
/// In the order of StepFacts::observation.
inline constexpr std::array<ObservedPart, 9> observedParts{{{"tip", "m", 3},
                                                            {"orientation", "", 4},
                                                            {"jaw", "rad", 1},
                                                            {"insertion", "m", 1},
                                                            {"contact_force", "N", 3},
                                                            {"structure_force", "N", structureWidth},
                                                            {"grasp_force", "N", 1},
                                                            {"hand_force", "N", 3},
                                                            {"time", "s", 0}}};

/// Keeps the newest step's facts.
class FactsObserver final : public recorder::Observer {
 public:
  explicit FactsObserver(const SceneDescription& scene)
      : judge_(scene), stepSeconds_(tickLength * static_cast<double>(scene.ticksPerStep)) {}
  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome /*outcome*/) override {}

  [[nodiscard]] const StepFacts& facts() const { return facts_; }

 private:
  void observe(const recorder::StepRecord& record);

  Judge judge_;
  double stepSeconds_;
  StepFacts facts_;
};

/// Unit of every field of a StepResult, by its name without "/observables/"; empty: none.
std::map<std::string, std::string> resultUnits();

}  // namespace calot::python
