// SPDX-License-Identifier: GPL-3.0-or-later
// One trainee at one scene: attempts one after the other, each recorded as `calot record --live` records. No window.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gui/trainer/attempt_monitor.h"
#include "recorder/base/files.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/station_key.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/window_input.h"
#include "recorder/sources/source.h"

namespace calot::gui {

/// Input of the trainer: opens a source for each attempt and ties it to its run. Called by the session's thread
/// alone. What open() gave is what the other functions are given.
class AttemptInput {
 public:
  virtual ~AttemptInput() = default;

  /// A source for a new attempt. @throws calot::Error where it is not there
  virtual std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) = 0;

  /// Before the first tick of a branch: hands and endoscope of the source set out from here.
  virtual void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start);

  /// Mode of the attempts to come, between sessions, and the file of the device's calibration; empty: the one that it
  /// has. @throws Error where an assessment may not use it, as recorder::checkCalibration, or it is missing
  virtual void setMode(recorder::Mode /*mode*/, const std::filesystem::path& /*calibration*/) {}

  /// Requirements of the source on its run: feedback to motors.
  virtual void drive(recorder::SampleSource& /*source*/, recorder::RunSettings& /*run*/) {}
};

/// Both hands by mouse and keyboard. An assessment wants a calibration, which is declared.
class MouseAttemptInput final : public AttemptInput {
 public:
  /// Lets an endoscope move with the hands of a source (ScopeSource).
  using AddScope = std::function<std::unique_ptr<recorder::SampleSource>(std::unique_ptr<recorder::SampleSource>,
                                                                         const SceneDescription&)>;

  /// @param mouse what the window writes to; not null. @param addScope empty: the camera is fixed
  explicit MouseAttemptInput(std::shared_ptr<recorder::MouseInput> mouse, AddScope addScope = {});

  std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) override;
  void setOut(recorder::SampleSource& source, const SceneDescription& scene, const TickSamples& start) override;
  void setMode(recorder::Mode mode, const std::filesystem::path& calibration) override;

 private:
  std::shared_ptr<recorder::MouseInput> mouse_;
  recorder::DeviceSourceSettings settings_;
  AddScope addScope_;
};

struct TrainingSettings {
  recorder::LoadedScene scene;
  recorder::AttemptSettings attempt;  ///< participant, station, mode, seed, ...
  std::optional<recorder::StationKey> key;
  std::filesystem::path folder;             ///< where recordings go; it exists. Empty: they go with the session
  unsigned threads = 1;                     ///< of the simulation
  MakeBroadPhase makeBroadPhase = nullptr;  ///< of the simulation; null: the grid
  /// How long an attempt waits for its first picture, at most: OpenGL's programs are compiled for it.
  std::chrono::milliseconds firstPicture{0};
  std::chrono::milliseconds countdown{3000};  ///< after going back, until the hands take effect
  std::chrono::milliseconds exchange{3000};   ///< an exchange of instruments takes so long of the attempt
  /// A new attempt by a device begins, and its time with it, when its operator first moves a hand.
  bool fromFirstMotion = false;
};

/// State of the session.
enum class Stage : std::uint8_t {
  preparing,     ///< a scene is built, a device waited for
  takingParent,  ///< going back: the parent's steps are simulated again
  countdown,     ///< gone back: the picture is there, the hands take effect in a moment
  ready,         ///< the picture is there, time starts with the first motion
  running,
  paused,
  ended,  ///< nothing runs; what there was is recorded
};

struct TrainingStatus {
  Stage stage = Stage::preparing;
  double progress = 0.0;        ///< of takingParent, from 0 to 1
  int countdown = 0;            ///< of that stage: seconds still to go, the last one begun counts
  bool waiting = false;         ///< it runs and no step has come for half a second: the device is gone
  std::string problem;          ///< why it could not go on, in one line; or empty
  std::filesystem::path file;   ///< of the attempt; empty before there is one
  bool kept = true;             ///< the file stays when the session ends
  bool locked = true;           ///< its file system granted a lock
  std::string attempt, parent;  ///< uuids; parent empty unless it is a branch
  std::filesystem::path parentFile;
  double branchedAt = 0.0;  ///< where a branch left its parent (s)
  recorder::OperatorKind operatorKind = recorder::OperatorKind::human;
  recorder::RunReport report;  ///< of the attempt that ended
  std::string undone;          ///< why an attempt that the trainee ended was abandoned; or empty
  /// For each hand: the instrument given while it has none.
  std::array<std::optional<recorder::ControlledSource::Exchange>, handCount> exchange;
  AttemptFigures figures;
};

/// Runs attempts on a thread of its own with the loops of a live run. Commands return at once; a command that the rules
/// do not allow now does nothing and returns false. Any thread may call.
///
/// The rules of the modes hold here, whatever a window offers: an assessment is neither paused nor branched.
class TrainingSession {
 public:
  /// @param input not null. @param sink is given views of the scene, on the session's thread; must not wait
  TrainingSession(TrainingSettings settings, std::shared_ptr<AttemptInput> input, ViewTap::Sink sink);
  /// Ends what runs as stopped; its recording is whole.
  ~TrainingSession();

  /// A new attempt from the scene's beginning. One that runs ends as abandoned.
  void start();
  bool pause();
  bool resume();
  /// The trainee has done: completed where the scene's procedure is, or where it has none and tissue was touched; else
  /// abandoned (TrainingStatus::undone).
  bool finish();
  /// Ends what runs as stopped, and goes on from that moment of it in a branch.
  /// @param time of the attempt (s), not before its first step's end and not after its last step
  bool goBack(double time);
  /// Goes on from a moment of any recording, of whomever: a branch of it by this session's participant. Its faults are
  /// in the status. Practice only.
  /// @param time of that attempt (s)
  bool branchOf(const std::filesystem::path& recording, double time);
  /// Exchanges a hand's instrument, which takes TrainingSettings::exchange; meanwhile the hand has none.
  bool mount(Hand hand, InstrumentKind instrument);
  /// Asks the assistant for more or less retraction.
  bool askForRetraction(bool more);
  /// Ends what runs as stopped and waits for its recording; no command does anything any more.
  void stop();
  /// A view was shown. @param step how many steps its State has behind it. @return how long ago the last motion in it
  /// was asked for (s); none where that is not known
  std::optional<double> shown(std::uint64_t step);

  [[nodiscard]] TrainingStatus status() const;
  [[nodiscard]] recorder::Mode mode() const { return settings_.attempt.mode; }
  [[nodiscard]] const SceneDescription& scene() const { return settings_.scene.description; }
  [[nodiscard]] const std::string& summary() const { return settings_.scene.summary; }
  /// Recordings that are kept so far, two lines each for a terminal: what was recorded, and how punctual its forces
  /// were.
  [[nodiscard]] std::vector<std::string> recorded() const;

 private:
  struct Command {
    bool quit = false;
    std::optional<double> back = {};    ///< go back to this time; none: a new attempt
    std::filesystem::path parent = {};  ///< of that recording; empty: of the last attempt
  };
  struct Interrupted {};  ///< thrown where another command came before a run began

  void post(Command command, recorder::Outcome ending);
  void work();
  void attempt(const Command& command);
  void takeParent(recorder::Recording& parent, recorder::Session& session, std::uint64_t fork,
                  recorder::RecordingWriter& writer);
  void run(recorder::Session& session, recorder::SampleSource& source, recorder::ControlledSource& controlled,
           recorder::RecordingWriter& writer, AttemptMonitor& monitor, const recorder::AttemptHeader& header,
           const std::filesystem::path& file);
  using Clock = std::chrono::steady_clock;
  /// Calls again and again, with the time that is left, until that is over, the call returns false, or a command comes.
  void during(Clock::duration time, const std::function<bool(Clock::duration)>& call);
  void keepResult(const recorder::RunReport& report, const recorder::SampleSource& source);
  void giveWay() const;

  TrainingSettings settings_;
  std::optional<recorder::TemporaryFolder> temporary_;  ///< of recordings that are not kept
  std::shared_ptr<AttemptInput> input_;
  ViewTap tap_;
  MotionClock motions_;
  std::shared_ptr<recorder::PreparedScene> prepared_;  ///< the thread's, made by it

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Command> command_;
  TrainingStatus status_;
  std::vector<std::string> recorded_;
  recorder::ControlledSource* controlled_ = nullptr;  ///< while a run is under way
  AttemptMonitor* monitor_ = nullptr;                 ///< likewise
  std::thread thread_;                                // last: it uses what is above
};

/// A name that no file of the folder has, for the recording of an attempt: "cholecystectomy-20260203T140500Z.h5", with
/// "-2" and so on behind the time where that is taken.
/// @param startUtc as headers have it: "2026-02-03T14:05:00Z"
[[nodiscard]] std::filesystem::path freshFile(const std::filesystem::path& folder, const std::string& scene,
                                              const std::string& startUtc);

}  // namespace calot::gui
