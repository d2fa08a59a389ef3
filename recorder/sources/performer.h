// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/sources/operation_mind.h"
#include "recorder/sources/performer_profile.h"
#include "recorder/sources/pointing.h"
#include "recorder/sources/scene_surfaces.h"
#include "recorder/sources/source.h"
#include "sim/judgement/judge.h"
#include "sim/math/random.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// The performer for a scene's task: where there is something to clear, divide or free, one in closed loop
/// (OperationSource); else one that touches the organs (PerformerSource).
/// @throws Error (invalid) where the scene offers a hand nothing to do.
std::unique_ptr<SampleSource> makePerformer(const PerformerProfile& profile, const SceneDescription& scene,
                                            std::uint64_t seed);

/// A synthetic operator in closed loop: it holds the specimen with one hand and with the other clears vessels of fat,
/// frees the lower third of the bed, clips, cuts, and frees the rest, as far as the scene has these.
/// docs/explanation/operating-performers.md.
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

/// A point of an organ's surface that a hand can touch and the operator can see.
struct TouchTarget {
  std::size_t organ = 0;
  Vec3 point = Vec3::Zero();     ///< p_W (m)
  Vec3 normal = Vec3::UnitY();   ///< outward, unit
  Vec3 approach = Vec3::Zero();  ///< p_W from which the way to the point and the way back to the port are free (m)
};

/// All targets of a hand, by organ and then by triangle; one at the middle of each triangle where - the normal looks at
/// the camera and against the shaft, each by 20 degrees at least; - the point lies inside the picture and inside the
/// workspace, with 10 mm to spare; - from camera and from port the point is in sight: no organ is crossed on the way; -
/// the point `pullBack` nearer to the port is 5 mm clear of every organ.
std::vector<TouchTarget> touchTargets(const SceneDescription& scene, const SceneSurfaces& surfaces, std::size_t hand,
                                      double pullBack);

/// True when an instrument's tip can move from a to b in a straight line and stay `clearance` (m) off every organ.
bool isFree(const SceneSurfaces& surfaces, const Vec3& a, const Vec3& b, double clearance);

/// One stroke of a hand: a straight line with minimum-jerk progress.
struct Stroke {
  double start = 0.0, duration = 0.0;           ///< s
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< p_WI (m)
  double jawFrom = 0.0, jawTo = 0.0;            ///< rad
  double rollFrom = 0.0, rollTo = 0.0;          ///< rad
};

/// Plans the strokes of one hand; draws from its own generator.
class StrokePlan {
 public:
  StrokePlan(const PerformerProfile& profile, const SceneDescription& scene, const SceneSurfaces& surfaces,
             std::size_t hand, std::uint64_t seed);

  /// Reaches for a target, presses, dwells, and pulls back.
  void touch(const TouchTarget& target);
  void goHome();
  /// A target of the organ, one that can be reached from home in free space; draws until one fits.
  /// @throws Error (invalid) where the scene offers this hand none on any organ.
  TouchTarget draw(std::size_t preferredOrgan);

  [[nodiscard]] double time() const { return time_; }
  void waitUntil(double time);
  void wait(double seconds) { time_ += seconds; }
  [[nodiscard]] const std::vector<Stroke>& strokes() const { return strokes_; }

 private:
  /// A stroke from where the tip is; it ends near `goal`, by the noise of its length.
  void strokeTo(const Vec3& goal, double speed, double jaw, double roll);
  void travelTo(const Vec3& goal, double roll);
  double normal(double mean, double spread);
  [[nodiscard]] Vec3 seenError();

  const PerformerProfile& profile_;
  const SceneDescription& scene_;
  const SceneSurfaces& surfaces_;
  std::size_t hand_;
  Random random_;
  std::vector<TouchTarget> targets_;
  std::vector<Stroke> strokes_;
  double time_ = 0.0, jaw_ = 0.0, roll_ = 0.0;
  Vec3 tip_;
};

/// A synthetic operator, open loop: touches targets on the organs with each hand and returns home; then it ends.
///
/// Strokes are minimum-jerk (Flash and Hogan 1985) with noise that grows with their length (Harris and Wolpert 1998);
/// between targets the instrument is pulled back towards its port (Chmarra et al. 2008). The same profile, scene and
/// seed give the same samples. The camera rests at the scene's pose. Parameters and their sources:
/// docs/explanation/sources.md.
class PerformerSource : public SampleSource {
 public:
  /// @throws Error (invalid) where the scene offers a hand nothing to touch.
  PerformerSource(const PerformerProfile& profile, const SceneDescription& scene, std::uint64_t seed);

  [[nodiscard]] const Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override;

  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Planned motion of the hand, without unsteadiness.
  [[nodiscard]] const std::vector<Stroke>& strokes(Hand hand) const { return strokes_[static_cast<std::size_t>(hand)]; }
  [[nodiscard]] const std::vector<TouchTarget>& targets(Hand hand) const {
    return targets_[static_cast<std::size_t>(hand)];
  }

 private:
  [[nodiscard]] InstrumentSample sampleOf(std::size_t hand, double time) const;

  Provenance provenance_;
  std::array<HandDescription, handCount> hands_;
  CameraSample camera_;
  std::array<std::vector<Stroke>, handCount> strokes_;
  std::array<std::vector<TouchTarget>, handCount> targets_;
  std::vector<Unsteadiness> tremor_, wander_;  ///< by hand
  std::uint64_t ticks_ = 0;
};

}  // namespace calot::recorder
