// SPDX-License-Identifier: GPL-3.0-or-later
// An attempt that Python advances: a StepwiseAttempt whose commands come as rows of numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "python/moment.h"
#include "python/step_facts.h"
#include "recorder/engine/wire.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/loop.h"

namespace calot::python {

/// x, y, z (m), roll (rad), jaw (rad), buttons (bits) of a hand.
inline constexpr std::size_t numbersOfHand = 6;
inline constexpr std::size_t numbersOfAction = numbersOfHand * handCount;

/// May be used by several threads, one at a time.
class DrivenAttempt {
 public:
  /// @param scene name or file @throws Error as recorder::findScene(), loadScene() and prepareScene()
  DrivenAttempt(const std::string& scene, std::uint64_t seed);

  void record(const std::filesystem::path& target, const recorder::AttemptSettings& settings,
              const recorder::Provenance& controller, bool force);
  /// One step. @pre numbersOfAction numbers
  recorder::Outcome step(std::span<const double> action);
  /// Steps until the actions are used up or the attempt is over. @returns how many steps were done, with a row of
  /// results of each
  std::size_t run(std::span<const double> actions, Bytes& rows);
  void end(recorder::Outcome outcome);

  /// @param name of an instrument, or "none" @throws Error (invalid)
  void mount(Hand hand, const std::string& name);
  void look(const Vec3& position, const Quat& orientation);

  [[nodiscard]] Moment moment() const;
  [[nodiscard]] std::vector<double> action() const;  ///< where the hands are
  [[nodiscard]] const StepFacts& facts() const { return facts_.facts(); }
  [[nodiscard]] const Model& model() const { return attempt_.model(); }
  [[nodiscard]] std::uint64_t steps() const { return attempt_.steps(); }
  [[nodiscard]] bool ended() const { return attempt_.ended(); }
  [[nodiscard]] recorder::Outcome outcome() const { return attempt_.outcome(); }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return loaded_.warnings; }

 private:
  [[nodiscard]] recorder::HandCommands commandsOf(std::span<const double> action) const;

  mutable std::mutex mutex_;
  recorder::LoadedScene loaded_;
  std::shared_ptr<recorder::PreparedScene> scene_;
  FactsObserver facts_;  // the attempt has to end before it
  recorder::StepwiseAttempt attempt_;
  std::array<InstrumentKind, handCount> mounted_{};
};

}  // namespace calot::python
