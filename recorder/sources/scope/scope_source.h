// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/pointing.h"
#include "recorder/sources/scope/endoscope.h"
#include "recorder/sources/source.h"
#include "sim/math/record.h"

namespace calot::recorder {

/// Another source's hands, with an endoscope that moves: its pose takes the place of the source's camera in every tick,
/// and so is recorded. Replay needs neither the endoscope nor who held it.
///
/// The endoscope is no body: it touches nothing, and the simulation of the tissue is the same whatever it does.
class ScopeSource final : public WrappedSource {
 public:
  /// @param source, driver not null
  ScopeSource(std::unique_ptr<SampleSource> source, const Endoscope& endoscope, std::unique_ptr<ScopeDriver> driver);

  /// Before the first tick: the endoscope sets out from this pose instead of its start (a branch).
  void setOutFrom(const CameraSample& camera);
  /// The run must keep the pace of the clock.
  [[nodiscard]] bool realTime() const { return driver_->realTime(); }

  bool next(std::uint64_t tick, TickSamples& out) override;
  void rest() override;
  [[nodiscard]] ScopeSource* scope() override { return this; }

 private:
  std::unique_ptr<SampleSource> owned_;
  Endoscope endoscope_;
  std::unique_ptr<ScopeDriver> driver_;
  ScopeMotion motion_;
};

/// How well an assistant holds the endoscope. Part of a performer's profile.
struct ScopeSkill {
  double reaction = 0.35;      ///< from one look at the picture to the next (s)
  double deadZone = 0.4;       ///< how far the work may leave the picture's centre (halves of the picture's height)
  double horizonError = 0.03;  ///< root mean square of the camera head's rotation from level (rad)

  static std::vector<Field> fields();
};

/// An assistant who follows the instruments: it looks at the picture every `reaction` seconds, and where the work has
/// left the dead zone it brings the work back to the centre, at the working distance. The light cable stays up, the
/// camera head drifts about level.
///
/// The work lies between both tips, nearer to the one that moves faster or whose pedal is pressed. Deterministic: the
/// same hands and seed give the same poses.
class ScopeAssistant final : public ScopeDriver {
 public:
  ScopeAssistant(const Endoscope& endoscope, const ScopeSkill& skill, std::uint64_t seed);

  void setOut(const ScopeJoints& joints) override { aim_ = joints; }
  [[nodiscard]] ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) override;

 private:
  struct Tip {
    bool there = false;
    Vec3 position = Vec3::Zero();
    double speed = 0.0;  ///< smoothed (m/s)
    bool works = false;  ///< a pedal is pressed
  };
  void watch(const TickSamples& hands);
  void look(const ScopeJoints& present);

  const Endoscope endoscope_;
  const ScopeSkill skill_;
  Unsteadiness drift_;
  std::array<Tip, handCount> tip_;
  ScopeJoints aim_;
  double nextLook_ = 0.0;
  bool following_ = false;
};

}  // namespace calot::recorder
