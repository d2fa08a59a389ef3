// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "recorder/engine/observer.h"
#include "recorder/sources/operation_mind.h"
#include "recorder/sources/performer_hand.h"
#include "recorder/sources/performer_profile.h"
#include "recorder/sources/performer_sight.h"
#include "recorder/sources/source.h"
#include "sim/judgement/judge.h"

namespace calot::recorder {

/// A synthetic operator in closed loop: it holds the specimen with one hand and with the other clears vessels of fat,
/// frees the lower third of the bed, clips, cuts, and frees the rest, as far as the scene has these.
/// docs/explanation/sources.md.
///
/// It observes when a hand is idle, and decides one reaction time later. It must therefore receive every step
/// (watcher()); otherwise its hands stay still. The same profile, scene, seed and steps give the same samples. At real
/// time the loop and the haptic thread call it at once.
class OperationSource final : public SampleSource, private Observer {
 public:
  OperationSource(const PerformerProfile& profile, const SceneDescription& scene, std::uint64_t seed);

  [[nodiscard]] const Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override;
  [[nodiscard]] Observer* watcher() override { return this; }
  [[nodiscard]] Outcome ending() const override;

 private:
  static constexpr std::size_t worker = 1;

  void onStep(const StepRecord& record) override;
  void onEnd(Outcome) override {}
  void decide(double time);
  [[nodiscard]] bool idleIn(double seconds, double time) const;

  const PerformerProfile profile_;
  const SceneDescription scene_;
  Provenance provenance_;
  PerformerSight anatomy_;
  std::array<PerformerHand, handCount> hand_;
  HoldingMind holding_;
  WorkingMind working_;
  Judge judge_;
  Random random_;
  bool wantsToLook_ = false;
  std::optional<Sight> sight_;
  std::uint32_t badClips_ = 0;
  double decideAt_ = 0.0, endAt_ = -1.0;
  bool gaveUp_ = false;
};

}  // namespace calot::recorder
