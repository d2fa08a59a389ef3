// SPDX-License-Identifier: GPL-3.0-or-later
// Events that a trainee may want to undo.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gui/words/event_words.h"
#include "recorder/engine/observer.h"
#include "sim/judgement/judge.h"
#include "sim/scene/model.h"

namespace calot::gui {

/// So long before a mistake a branch sets out (s).
inline constexpr double goBackBy = 2.0;

/// An error in one step with one structure, or repeated within a second.
struct Mistake {
  double time = 0.0;      ///< of the attempt, when it first happened (s)
  bool critical = false;  ///< fails an assessment
  std::string text;       ///< one line: "cystic duct: clip half on"

  /// Fork of the branch (s): goBackBy earlier, or the end of the first step.
  [[nodiscard]] double branchTime(double stepSeconds) const;
};

/// The mistakes of an attempt in the order of time: all events that should not happen (EventWords::fault).
class MistakeList {
 public:
  MistakeList(SubjectNames names, double stepSeconds);

  /// The events of one step. @returns whether something was added
  bool add(std::span<const Event> events);

  [[nodiscard]] const std::vector<Mistake>& all() const { return all_; }

 private:
  SubjectNames names_;
  double stepSeconds_;
  std::vector<Mistake> all_;
  std::vector<double> last_;  ///< per mistake, when it last happened (s)
};

/// State of an attempt, for the window.
struct AttemptFigures {
  struct Hand {
    InstrumentKind instrument = InstrumentKind::none;
    double jaw = 0.0;         ///< rad
    bool holds = false;       ///< tissue is in its jaws
    std::uint32_t clips = 0;  ///< left in its clip applier
    Cautery cautery = Cautery::off;
    bool measured = true;                 ///< its device gives samples
    Vec3 tip = Vec3::Zero();              ///< p_CI, where contact lets it be: right, down, away from the endoscope (m)
    Quat orientation = Quat::Identity();  ///< q_WI
  };
  struct Vessel {
    std::uint32_t clips = 0;     ///< on it
    std::uint32_t partings = 0;  ///< where it is cut, burned or torn through
  };
  double time = 0.0;  ///< of the attempt (s)
  std::array<Hand, handCount> hand;
  std::vector<Vessel> vessel;
  ProcedureStatus procedure;
  bool touched = false;               ///< an instrument has touched, grasped or burned tissue so far
  std::optional<double> retraction;   ///< how far the assistant's pull goes, where it can be asked for (m)
  double attached = 0.0;              ///< of the procedure's bed, as a share
  std::uint64_t ticks = 0;            ///< of this run: a branch counts from its fork on
  std::uint64_t missedDeadlines = 0;  ///< of those
  std::uint64_t missedLately = 0;     ///< of the ticks of the last hundred steps
  double stretched = 0.0;             ///< by how much the tick clock was (s)
  std::shared_ptr<const std::vector<Mistake>> mistakes;  ///< never null
  std::chrono::steady_clock::time_point seen;            ///< when the last step was over

  AttemptFigures() : mistakes(std::make_shared<const std::vector<Mistake>>()) {}
};

/// Watches an attempt for the window. Steps come on the simulation's thread, any thread may ask.
class AttemptMonitor final : public recorder::Observer {
 public:
  /// @param model outlives this
  explicit AttemptMonitor(const Model& model);

  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome /*outcome*/) override {}

  [[nodiscard]] AttemptFigures figures() const;
  /// Steps are to come from now on: a pause is over.
  void expectSteps();

  /// The steps up to here were a parent's: deadlines count from now on. Simulation's thread.
  void beginRun();
  /// Newest measured pose of each hand, with the instrument that it had last, and the camera. Simulation's thread.
  [[nodiscard]] const TickSamples& lastPose() const { return lastPose_; }

 private:
  const Model& model_;
  Judge judge_;  ///< simulation's thread
  MistakeList list_;
  std::size_t bed_;  ///< index of the procedure's connective tissue; none: how many there are
  TickSamples lastPose_;
  std::array<std::uint32_t, 100> missed_{};  ///< in each of the last steps
  std::size_t slot_ = 0;

  mutable std::mutex mutex_;
  AttemptFigures figures_;
};

}  // namespace calot::gui
