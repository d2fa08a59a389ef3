// SPDX-License-Identifier: GPL-3.0-or-later
// What a window learns of an attempt: its state, the errors that a trainee may want to undo, its views, and how
// smoothly they come.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gui/words/event_words.h"
#include "recorder/engine/fallen_clips.h"
#include "recorder/engine/observer.h"
#include "recorder/engine/session.h"
#include "recorder/sources/source.h"
#include "sim/judgement/judge.h"
#include "sim/scene/model.h"

namespace calot::gui {

/// So long before a mistake a branch sets out (s).
inline constexpr double goBackBy = 2.0;

/// Fork of the branch for an error at that time: goBackBy earlier, or the end of the first step (s).
[[nodiscard]] double branchTime(double time, double stepSeconds);

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
    double force = 0.0;                   ///< that tissue exerts on it (N)
    double depth = 0.0;                   ///< how far its tip went against that force since it touched (m)
    double greatestForce = 0.0;           ///< of the attempt so far (N)
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
  std::shared_ptr<const std::vector<analytics::ErrorLine>> errors;  ///< the gravest first; never null
  std::uint64_t noticed = 0;                                        ///< how often something went wrong: occasions
  std::shared_ptr<const analytics::ErrorLine> latest;               ///< the gravest of the newest occasion; or null
  std::chrono::steady_clock::time_point seen;                       ///< when the last step was over

  AttemptFigures() : errors(std::make_shared<const std::vector<analytics::ErrorLine>>()) {}
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
  void noteErrors(const Judgement& judgement);
  double depthOf(std::size_t h, const HandResult& hand);

  const Model& model_;
  Judge judge_;  ///< simulation's thread
  SubjectNames names_;
  std::size_t bed_;  ///< index of the procedure's connective tissue; none: how many there are
  TickSamples lastPose_;
  std::uint64_t occasions_ = 0;                             ///< of errors, as listed
  std::array<std::optional<Vec3>, handCount> touchedAt_{};  ///< p_WI of a tip when it began to touch tissue
  std::array<std::uint32_t, 100> missed_{};                 ///< in each of the last steps
  std::size_t slot_ = 0;

  mutable std::mutex mutex_;
  AttemptFigures figures_;
};

/// When the last motion of each of the latest steps was asked for: with it a window says how long after a motion of the
/// hands the picture of it was there. What lies between device and source is not in it (a calibration measures that).
class MotionClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// One thread, the one that asks for ticks.
  void asked(std::uint64_t step, Time now);
  /// Any thread: none where the step is not among the latest.
  [[nodiscard]] std::optional<Time> of(std::uint64_t step) const;

 private:
  struct Entry {
    std::atomic<std::uint64_t> step{~std::uint64_t{0}};
    std::atomic<Time::rep> ticks{0};
  };
  static constexpr std::size_t kept = 256;  ///< steps: 2.56 s
  std::array<Entry, kept> entries_;
};

/// A source whose ticks are noted in a MotionClock.
class ClockedSource final : public recorder::WrappedSource {
 public:
  /// @param source, clock outlive this. @param firstStep of the attempt, in which the source's tick 0 lies
  ClockedSource(recorder::SampleSource& source, MotionClock& clock, std::uint64_t firstStep, std::uint32_t ticksPerStep)
      : WrappedSource(source), clock_(clock), firstStep_(firstStep), ticksPerStep_(ticksPerStep) {}

  bool next(std::uint64_t tick, TickSamples& out) override;

 private:
  MotionClock& clock_;
  std::uint64_t firstStep_;
  std::uint32_t ticksPerStep_;
};

/// How smoothly an operation was seen while it was running: pictures a second, the longest time that one stood, how
/// large they were drawn, and how long after a motion of the hands it was on the screen. Pauses and what comes after
/// the end do not count. One thread.
class PictureRate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Sets whether the operation moves from now on.
  void setRunning(bool running);
  /// A picture came on the screen. @param side its share of the size that it is shown in. @param delay since the last
  /// motion that is in it (s); none where that is not known
  void shown(Time now, double side = 1.0, std::optional<double> delay = {});

  [[nodiscard]] std::uint64_t pictures() const { return pictures_; }  ///< that followed another one
  [[nodiscard]] double seconds() const { return seconds_; }           ///< from the first one to the last
  [[nodiscard]] double longest() const { return longest_; }           ///< between two (s)
  /// Mean pictures a second; 0 before there were two.
  [[nodiscard]] double mean() const { return seconds_ > 0.0 ? static_cast<double>(pictures_) / seconds_ : 0.0; }

  /// Mean share of the size that they are shown in; 1 before there were two.
  [[nodiscard]] double side() const { return pictures_ > 0 ? sides_ / static_cast<double>(pictures_) : 1.0; }
  /// Delay (s) not exceeded by that share of the pictures; none if it was never known.
  [[nodiscard]] std::optional<double> delay(double share) const;

  /// "25.3 pictures a second of 1280x720 in 25.0 s, ...": one line for a terminal.
  [[nodiscard]] std::string report(int width, int height, const std::string& drawnBy) const;

 private:
  bool running_ = false;
  std::optional<Time> last_;
  std::uint64_t pictures_ = 0;
  double seconds_ = 0.0, longest_ = 0.0, sides_ = 0.0;
  std::vector<float> delays_;
};

/// Hands out views of a running attempt, as many as are looked at: at most one in 30 ms, and none while three are
/// still to be shown, since each costs the simulation's thread the surfaces of the scene.
class ViewTap final : public recorder::Observer {
 public:
  using Sink = std::function<void(std::shared_ptr<const SceneView>)>;

  /// @param sink called on the simulation's thread; must not wait
  explicit ViewTap(Sink sink) : sink_(std::move(sink)) {}

  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome /*outcome*/) override {}

  /// Before begin(): events of the steps that the session has done, which a branch has of its parent.
  void setOutFrom(std::vector<Event> before) { before_ = std::move(before); }
  /// Hands out a view of a session that it is to be joined to.
  void begin(recorder::Session& session);
  /// Any thread: a view has been shown.
  void shown() { underway_ = 0; }
  /// Has the newest one that was handed out been shown, or one after it?
  [[nodiscard]] bool isShown() const { return underway_ == 0; }
  [[nodiscard]] std::uint64_t taken() const { return taken_; }  ///< views handed out

 private:
  using Clock = std::chrono::steady_clock;

  void handOut(SceneView view);

  Sink sink_;
  std::vector<Event> before_;
  std::optional<recorder::FallenClips> fallen_;  ///< none before begin()
  Clock::time_point next_{};                     ///< when the next one is due
  Clock::time_point last_{};
  std::atomic<int> underway_{0};  ///< handed out since the last one was shown
  std::atomic<std::uint64_t> taken_{0};
};

}  // namespace calot::gui
