// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/training_session.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <utility>

#include "analytics/checkpoints/replay_words.h"
#include "gui/trainer/trainer_texts.h"
#include "gui/words/problem_words.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/scope/scope_source.h"
#include "recorder/sources/source.h"

namespace calot::gui {
namespace {

constexpr double patience = 5.0;  // s

/// Ports and the endoscope's eye in D (the scene's camera's axes), seen from where the tips begin.
void setPlaces(recorder::MouseInput& mouse, const SceneDescription& scene, const CameraSample& camera,
               const std::array<Vec3, handCount>& tips) {
  std::array<Vec3, handCount> ports, eyes;
  for (std::size_t h = 0; h < handCount; ++h) {
    ports[h] = scene.camera.orientation.conjugate() * Vec3(scene.hands[h].port - tips[h]);
    eyes[h] = scene.camera.orientation.conjugate() * Vec3(camera.position - tips[h]);
  }
  mouse.setPorts(ports);
  mouse.setEyes(eyes);
}

constexpr std::chrono::milliseconds longSilence(500);
constexpr std::chrono::hours untilAsked(24 * 365);

}  // namespace

void AttemptInput::setOut(recorder::SampleSource& source, const SceneDescription& /*scene*/, const TickSamples& start) {
  if (auto* const device = source.device(); device != nullptr) device->setOutFrom(start);
  if (auto* const scope = source.scope(); scope != nullptr) scope->setOutFrom(start.camera);
}

MouseAttemptInput::MouseAttemptInput(std::shared_ptr<recorder::MouseInput> mouse, AddScope addScope)
    : mouse_(std::move(mouse)), addScope_(std::move(addScope)) {}

void MouseAttemptInput::setMode(recorder::Mode mode, const std::filesystem::path& calibration) {
  std::optional<recorder::Calibration> used = settings_.calibration;
  if (!calibration.empty()) used = recorder::readCalibration(calibration);
  if (!used && mode == recorder::Mode::assessment)
    throw Error(ErrorKind::invalid, "an assessment by mouse and keyboard needs a calibration");
  if (used) {
    const recorder::DeviceInfo device = recorder::MouseDevice(mouse_).info();
    recorder::checkCalibration(*used, device, mode, recorder::presentDate(), calibration.string());
  }
  settings_.mode = mode;
  settings_.calibration = std::move(used);
}

std::unique_ptr<recorder::SampleSource> MouseAttemptInput::open(const SceneDescription& scene) {
  mouse_->reset();
  setPlaces(*mouse_, scene, scene.camera, {scene.hands[0].home, scene.hands[1].home});
  auto source =
      std::make_unique<recorder::DeviceSource>(std::make_unique<recorder::MouseDevice>(mouse_), scene, settings_);
  source->waitForFirst(patience);
  if (addScope_) return addScope_(std::move(source), scene);
  return source;
}

void MouseAttemptInput::setOut(recorder::SampleSource& source, const SceneDescription& scene,
                               const TickSamples& start) {
  setPlaces(*mouse_, scene, start.camera, {start.hand[0].position, start.hand[1].position});
  AttemptInput::setOut(source, scene, start);
}

using recorder::Outcome;

TrainingSession::TrainingSession(TrainingSettings settings, std::shared_ptr<AttemptInput> input, ViewTap::Sink sink)
    : settings_(std::move(settings)), input_(std::move(input)), tap_(std::move(sink)) {
  if (settings_.folder.empty()) {
    settings_.folder = temporary_.emplace().path();
    status_.kept = false;
  }
  thread_ = std::thread([this] { work(); });
}

TrainingSession::~TrainingSession() { stop(); }

void TrainingSession::stop() {
  post({true}, Outcome::stopped);
  if (thread_.joinable()) thread_.join();
}

void TrainingSession::post(Command command, Outcome ending) {
  {
    const std::lock_guard lock(mutex_);
    if (command_ && command_->quit) return;
    command_ = command;
    if (controlled_ != nullptr) controlled_->finish(ending);
  }
  wake_.notify_one();
}

void TrainingSession::start() { post({}, Outcome::abandoned); }

bool TrainingSession::goBack(double time) {
  {
    const std::lock_guard lock(mutex_);
    const bool there =
        status_.stage == Stage::running || status_.stage == Stage::paused || status_.stage == Stage::ended;
    if (mode() != recorder::Mode::practice || !there || status_.file.empty()) return false;
    const double now = monitor_ != nullptr ? monitor_->figures().time : status_.figures.time;
    const double stepSeconds = tickLength * scene().ticksPerStep;
    if (!(time >= stepSeconds && time <= now)) return false;
  }
  post({false, time}, Outcome::stopped);
  return true;
}

bool TrainingSession::branchOf(const std::filesystem::path& recording, double time) {
  if (mode() != recorder::Mode::practice) return false;
  post({false, time, recording}, Outcome::stopped);
  return true;
}

bool TrainingSession::pause() {
  const std::lock_guard lock(mutex_);
  if (mode() != recorder::Mode::practice || controlled_ == nullptr || status_.stage != Stage::running) return false;
  controlled_->hold(true);
  status_.stage = Stage::paused;
  return true;
}

bool TrainingSession::resume() {
  const std::lock_guard lock(mutex_);
  if (controlled_ == nullptr || status_.stage != Stage::paused) return false;
  monitor_->expectSteps();
  controlled_->hold(false);
  status_.stage = Stage::running;
  return true;
}

bool TrainingSession::finish() {
  const std::lock_guard lock(mutex_);
  if (controlled_ == nullptr) return false;
  status_.undone = whatIsUndone(scene(), monitor_->figures());
  controlled_->finish(status_.undone.empty() ? Outcome::completed : Outcome::abandoned);
  return true;
}

bool TrainingSession::mount(Hand hand, InstrumentKind instrument) {
  const std::lock_guard lock(mutex_);
  if (controlled_ == nullptr || status_.stage != Stage::running) return false;
  controlled_->exchange(hand, instrument, static_cast<std::uint32_t>(settings_.exchange.count()));
  return true;
}

bool TrainingSession::askForRetraction(bool more) {
  const std::lock_guard lock(mutex_);
  if (controlled_ == nullptr || status_.stage != Stage::running) return false;
  controlled_->ask(more);
  return true;
}

std::optional<double> TrainingSession::shown(std::uint64_t step) {
  tap_.shown();
  const std::optional<MotionClock::Time> motion = step > 0 ? motions_.of(step - 1) : std::nullopt;
  if (!motion) return std::nullopt;
  return std::chrono::duration<double>(MotionClock::Time::clock::now() - *motion).count();
}

TrainingStatus TrainingSession::status() const {
  const std::lock_guard lock(mutex_);
  TrainingStatus out = status_;
  if (monitor_ != nullptr) out.figures = monitor_->figures();
  for (const Hand hand : {Hand::left, Hand::right}) {
    if (controlled_ != nullptr) out.exchange[static_cast<std::size_t>(hand)] = controlled_->exchanging(hand);
  }
  out.waiting = out.stage == Stage::running && std::chrono::steady_clock::now() - out.figures.seen > longSilence;
  return out;
}

std::vector<std::string> TrainingSession::recorded() const {
  const std::lock_guard lock(mutex_);
  return recorded_;
}

void TrainingSession::work() {
  for (;;) {
    Command command;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return command_.has_value(); });
      command = *command_;
      if (command.quit) return;
      command_.reset();
    }
    std::string problem;
    try {
      attempt(command);
    } catch (const Interrupted&) {
    } catch (const std::exception& error) {
      problem = problemText(error);
    }
    const std::lock_guard lock(mutex_);
    // If something else is requested already, nothing has ended.
    if (!command_ || command_->quit) status_.stage = Stage::ended;
    if (!problem.empty()) status_.problem = problem;
  }
}

void TrainingSession::giveWay() const {
  const std::lock_guard lock(mutex_);
  if (command_) throw Interrupted{};
}

/// A new attempt, or a branch.
void TrainingSession::attempt(const Command& command) {
  const std::optional<double>& back = command.back;
  std::filesystem::path parentFile = command.parent;
  {
    const std::lock_guard lock(mutex_);
    status_.stage = back ? Stage::takingParent : Stage::preparing;
    status_.progress = 0.0;
    status_.problem.clear();
    if (parentFile.empty()) parentFile = status_.file;
  }
  if (!prepared_) prepared_ = recorder::prepareScene(settings_.scene.assets, Where{"scene " + scene().name});
  const Model& model = prepared_->model();
  const std::unique_ptr<recorder::SampleSource> source = input_->open(scene());
  giveWay();
  std::optional<recorder::Recording> parent;
  std::uint64_t fork = 0;
  if (back) {
    parent.emplace(parentFile);
    analytics::refuseBrokenParent(parentFile, parent->verifyChain());
    recorder::refuseParent(*parent);
    fork = recorder::forkStepAt(*parent, *back);
  }
  recorder::AttemptHeader header =
      parent ? recorder::branchHeader(*parent, model, fork, source->provenance())
             : recorder::makeHeader(model, settings_.scene.assets, source->provenance(), settings_.attempt);
  // The participant of a branch is the one who goes on, whoever made its parent.
  if (!settings_.attempt.participant.empty()) header.participant = settings_.attempt.participant;
  {
    const std::lock_guard lock(mutex_);
    status_.parentFile = parent ? parentFile : std::filesystem::path();
  }
  const std::filesystem::path file = freshFile(settings_.folder, scene().name, header.startUtc);
  std::optional<recorder::NewFile> place;  // until the parent's part is taken
  if (parent) place.emplace(file, false, ".branch");
  recorder::RecordingWriter writer(place ? place->path() : file, header, {parent.has_value(), settings_.key});
  recorder::WorkerPool pool(settings_.threads);
  recorder::Session session(model, header.seed, pool, prepared_->services(settings_.makeBroadPhase));
  AttemptMonitor monitor(model);
  session.join(writer);
  session.join(monitor);
  std::vector<Event> before = parent ? parent->events() : std::vector<Event>();
  std::erase_if(before, [fork](const Event& event) { return event.step >= fork; });
  tap_.setOutFrom(std::move(before));
  const auto record = [&] {
    if (auto* const device = source->device(); device != nullptr)
      writer.takeRawSamples(device->rawSamples(), session.steps() * scene().ticksPerStep);
  };
  if (!parent) {
    recorder::ControlledSource controlled(*source);
    record();
    run(session, *source, controlled, writer, monitor, header, file);
    return;
  }
  takeParent(*parent, session, fork, writer);
  place->publish();
  monitor.beginRun();
  const TickSamples start = monitor.lastPose();
  input_->setOut(*source, scene(), start);
  recorder::BlendedSource blended(*source, start);
  recorder::ControlledSource controlled(blended);
  // A device knows nothing of instruments: what was exchanged stays so. Other sources choose their own.
  if (!header.provenance.device.empty()) {
    for (const Hand hand : {Hand::left, Hand::right}) {
      const InstrumentKind had = start.hand[static_cast<std::size_t>(hand)].instrument;
      if (had != InstrumentKind::none) controlled.mount(hand, had);
    }
  }
  record();
  run(session, *source, controlled, writer, monitor, header, file);
}

void TrainingSession::takeParent(recorder::Recording& parent, recorder::Session& session, std::uint64_t fork,
                                 recorder::RecordingWriter& writer) {
  const auto divergence = recorder::takeParent(parent, session, fork, [&](std::uint64_t step, std::uint64_t of) {
    giveWay();
    if (writer.failed()) {
      session.end(Outcome::technicalFailure);
      writer.finish();  // says why
    }
    const std::lock_guard lock(mutex_);
    status_.progress = static_cast<double>(step) / static_cast<double>(of);
  });
  if (divergence) throw Error(ErrorKind::refused, Where{parent.path().string()}, analytics::wordsFor(*divergence));
}

void TrainingSession::run(recorder::Session& session, recorder::SampleSource& source,
                          recorder::ControlledSource& controlled, recorder::RecordingWriter& writer,
                          AttemptMonitor& monitor, const recorder::AttemptHeader& header,
                          const std::filesystem::path& file) {
  tap_.begin(session);
  session.join(tap_);
  // Nobody operates blindly. Meanwhile what the first steps need is worked out.
  const Clock::time_point begin = Clock::now();
  session.precompute();
  during(settings_.firstPicture - (Clock::now() - begin), [this](Clock::duration) { return !tap_.isShown(); });
  // A person who went back looks first and acts then. Motion of the hands meanwhile is discarded.
  if (!header.parent.empty()) {
    during(settings_.countdown, [&](Clock::duration left) {
      {
        const std::lock_guard lock(mutex_);
        status_.stage = Stage::countdown;
        status_.countdown = static_cast<int>(std::chrono::ceil<std::chrono::seconds>(left).count());
      }
      controlled.rest();
      return true;
    });
  } else if (auto* const device = source.device(); device != nullptr && settings_.fromFirstMotion) {
    const auto awaitMotion = [&](Clock::duration) {
      controlled.rest();
      const std::lock_guard lock(mutex_);
      status_.stage = Stage::ready;
      status_.figures = monitor.figures();
      return !device->moved();
    };
    during(untilAsked, awaitMotion);
  }
  recorder::RunSettings run;
  run.live = true;
  run.progress = [&](std::uint64_t) {
    if (writer.failed()) controlled.finish(Outcome::stopped);  // nothing more can be kept; finish() says why
  };
  input_->drive(source, run);
  recorder::RunReport report;
  const auto release = [](TrainingSession* trained) {
    const std::lock_guard lock(trained->mutex_);
    trained->status_.figures = trained->monitor_->figures();
    trained->controlled_ = nullptr;
    trained->monitor_ = nullptr;
  };
  {
    const std::unique_ptr<TrainingSession, decltype(release)> reachable(this, release);  // by commands
    {
      const std::lock_guard lock(mutex_);
      if (command_) controlled.finish(Outcome::stopped);  // it came while the run was made ready
      controlled_ = &controlled;
      monitor_ = &monitor;
      status_.stage = Stage::running;
      status_.file = file;
      status_.locked = writer.locked();
      status_.attempt = header.attempt;
      status_.parent = header.parent;
      status_.branchedAt = static_cast<double>(header.forkStep + 1) * session.model().stepSeconds();
      status_.operatorKind = header.provenance.kind;
      status_.report = {};
      status_.undone.clear();
    }
    ClockedSource clocked(controlled, motions_, session.steps(), scene().ticksPerStep);
    report = recorder::runAttempt(session, clocked, run);
  }
  writer.finish();
  prepared_->save();
  keepResult(report, source);
}

void TrainingSession::during(Clock::duration time, const std::function<bool(Clock::duration)>& call) {
  const Clock::time_point end = Clock::now() + time;
  for (Clock::time_point now = Clock::now(); now < end; now = Clock::now()) {
    {
      const std::lock_guard lock(mutex_);
      if (command_) return;
    }
    if (!call(end - now)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void TrainingSession::keepResult(const recorder::RunReport& report, const recorder::SampleSource& source) {
  const std::lock_guard lock(mutex_);
  if (report.steps == 0 && report.outcome == Outcome::stopped) {  // which is no attempt
    status_.file.clear();
    return;
  }
  status_.report = report;
  if (report.disagreements > 0) {
    status_.problem = fmt::format(
        "{}: {} ticks got other forces on the haptic thread than when computed again; the recording will not replay",
        status_.file.string(), report.disagreements);
  } else if (report.runaway) {
    status_.problem = fmt::format("{}: {}", status_.file.string(), analytics::wordsFor(*report.runaway));
  } else if (report.outcome == Outcome::technicalFailure) {
    status_.problem = source.statusText();
  }
  if (!status_.kept) return;
  recorded_.push_back(fmt::format("{}: attempt {}, {:.2f} s, {}", status_.file.string(), status_.attempt,
                                  status_.figures.time, recorder::wordFor(report.outcome)));
  if (report.ticks == 0) return;
  recorded_.push_back(fmt::format(
      "{}: {} of {} forces late ({:.2f} %), at most by {:.1f} ms; clock slowed by {:.2f} s; {}", status_.file.string(),
      report.missedDeadlines, report.ticks,
      100.0 * static_cast<double>(report.missedDeadlines) / static_cast<double>(report.ticks), 1e3 * report.maxLateness,
      report.stretched, report.realTime ? "real-time thread" : "ordinary thread (no permission for real time)"));
}

std::filesystem::path freshFile(const std::filesystem::path& folder, const std::string& scene,
                                const std::string& startUtc) {
  std::string when;
  std::copy_if(startUtc.begin(), startUtc.end(), std::back_inserter(when), [](char c) { return c != '-' && c != ':'; });
  const std::string stem = fmt::format("{}-{}", scene, when);
  std::filesystem::path file = folder / (stem + ".h5");
  for (int n = 2; std::filesystem::exists(file); ++n) file = folder / fmt::format("{}-{}.h5", stem, n);
  return file;
}

}  // namespace calot::gui
