// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/training_session.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "gui/trainer/trainer_texts.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/branch.h"
#include "recorder/live/worker_pool.h"
#include "recorder/live/wrapped_sources.h"

namespace calot::gui {

using recorder::Outcome;

namespace {

constexpr std::chrono::milliseconds longSilence(500);

}  // namespace

/// A run that commands can reach.
class TrainingSession::Registered {
 public:
  Registered(TrainingSession& session, recorder::ControlledSource& controlled, AttemptMonitor& monitor)
      : session_(session) {
    const std::lock_guard lock(session_.mutex_);
    if (session_.command_) controlled.finish(Outcome::stopped);  // it came while the run was made ready
    session_.controlled_ = &controlled;
    session_.monitor_ = &monitor;
  }
  ~Registered() {
    const std::lock_guard lock(session_.mutex_);
    session_.status_.figures = session_.monitor_->figures();
    session_.controlled_ = nullptr;
    session_.monitor_ = nullptr;
  }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;

 private:
  TrainingSession& session_;
};

TrainingSession::TrainingSession(TrainingSettings settings, std::shared_ptr<AttemptInput> input, ViewTap::Sink sink)
    : settings_(std::move(settings)), input_(std::move(input)), tap_(std::move(sink)), thread_([this] { work(); }) {}

TrainingSession::~TrainingSession() { stop(); }

void TrainingSession::stop() {
  post({true, std::nullopt}, Outcome::stopped);
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
      obey(command);
    } catch (const Interrupted&) {
    } catch (const std::exception& error) {
      problem = problemText(error);
    }
    const std::lock_guard lock(mutex_);
    // Where something else is wanted already, nothing has come to an end.
    if (!command_ || command_->quit) status_.stage = Stage::ended;
    if (!problem.empty()) status_.problem = problem;
  }
}

void TrainingSession::obey(const Command& command) {
  enter(command.back ? Stage::takingParent : Stage::preparing);
  prepare();
  if (command.back)
    branch(*command.back);
  else
    attempt();
}

void TrainingSession::enter(Stage stage) {
  const std::lock_guard lock(mutex_);
  status_.stage = stage;
  status_.progress = 0.0;
  status_.problem.clear();
}

void TrainingSession::giveWay() const {
  const std::lock_guard lock(mutex_);
  if (command_) throw Interrupted{};
}

void TrainingSession::prepare() {
  if (prepared_) return;
  prepared_ = recorder::prepareScene(settings_.scene.assets, Where{"scene " + scene().name});
}

void TrainingSession::attempt() {
  const std::unique_ptr<recorder::SampleSource> source = input_->open(scene());
  giveWay();
  recorder::ControlledSource controlled(*source);
  const recorder::AttemptHeader header =
      recorder::makeHeader(prepared_->model(), settings_.scene.assets, source->provenance(), settings_.attempt);
  const std::filesystem::path file = freshFile(settings_.folder, scene().name, header.startUtc);
  recorder::RecordingWriter writer(file, header, {false, settings_.key});
  recorder::WorkerPool pool(settings_.threads);
  recorder::Session session(prepared_->model(), header.seed, pool, prepared_->services(settings_.makeBroadPhase));
  AttemptMonitor monitor(prepared_->model());
  session.join(writer);
  session.join(monitor);
  input_->record(*source, writer, 0);
  run(session, *source, controlled, writer, monitor, header, file);
}

void TrainingSession::branch(double time) {
  std::filesystem::path parentFile;
  {
    const std::lock_guard lock(mutex_);
    parentFile = status_.file;
  }
  const std::unique_ptr<recorder::SampleSource> source = input_->open(scene());
  recorder::Recording parent(parentFile);
  recorder::refuseParent(parent, parent.verifyChain());
  const std::uint64_t fork = recorder::forkStepAt(parent, time);
  const recorder::AttemptHeader header = recorder::branchHeader(parent, prepared_->model(), fork, source->provenance());
  const std::filesystem::path file = freshFile(settings_.folder, scene().name, header.startUtc);
  recorder::BranchFile place(file, false);
  recorder::RecordingWriter writer(place.path(), header, {true, settings_.key});
  recorder::WorkerPool pool(settings_.threads);
  recorder::Session session(prepared_->model(), header.seed, pool, prepared_->services(settings_.makeBroadPhase));
  AttemptMonitor monitor(prepared_->model());
  session.join(writer);
  session.join(monitor);
  recorder::takeParent(parent, session, fork, [&](std::uint64_t step, std::uint64_t of) {
    giveWay();
    if (writer.failed()) {
      session.end(Outcome::technicalFailure);
      writer.finish();  // says why
    }
    const std::lock_guard lock(mutex_);
    status_.progress = static_cast<double>(step) / static_cast<double>(of);
  });
  place.publish();
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
  input_->record(*source, writer, session.steps() * scene().ticksPerStep);
  run(session, *source, controlled, writer, monitor, header, file);
}

void TrainingSession::run(recorder::Session& session, recorder::SampleSource& source,
                          recorder::ControlledSource& controlled, recorder::RecordingWriter& writer,
                          AttemptMonitor& monitor, const recorder::AttemptHeader& header,
                          const std::filesystem::path& file) {
  tap_.begin(session);
  session.join(tap_);
  awaitPicture(session);
  if (!header.parent.empty()) countDown(controlled);
  recorder::RunSettings run;
  run.live = true;
  run.progress = [&](std::uint64_t) {
    if (writer.failed()) controlled.finish(Outcome::stopped);  // nothing more can be kept; finish() says why
  };
  input_->drive(source, run);
  recorder::RunReport report;
  {
    const Registered registered(*this, controlled, monitor);
    {
      const std::lock_guard lock(mutex_);
      status_.stage = Stage::running;
      status_.file = file;
      status_.attempt = header.attempt;
      status_.parent = header.parent;
      status_.branchedAt = static_cast<double>(header.forkStep + 1) * prepared_->model().stepSeconds();
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

/// Nobody operates blindly. Meanwhile what the first steps need is worked out.
void TrainingSession::awaitPicture(recorder::Session& session) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds glance(10);
  const Clock::time_point end = Clock::now() + settings_.firstPicture;
  session.precompute();
  while (!tap_.isShown() && Clock::now() < end) {
    {
      const std::lock_guard lock(mutex_);
      if (command_) return;
    }
    std::this_thread::sleep_for(glance);
  }
}

/// Who went back looks first and acts then. What the hands do meanwhile is forgotten.
void TrainingSession::countDown(recorder::SampleSource& source) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds glance(10);
  const Clock::time_point end = Clock::now() + settings_.countdown;
  for (Clock::time_point now = Clock::now(); now < end; now = Clock::now()) {
    {
      const std::lock_guard lock(mutex_);
      if (command_) return;
      status_.stage = Stage::countdown;
      status_.countdown = static_cast<int>(std::chrono::ceil<std::chrono::seconds>(end - now).count());
    }
    source.rest();
    std::this_thread::sleep_for(glance);
  }
}

void TrainingSession::keepResult(const recorder::RunReport& report, const recorder::SampleSource& source) {
  const std::lock_guard lock(mutex_);
  status_.report = report;
  if (report.disagreements > 0) {
    status_.problem = fmt::format(
        "{}: {} ticks got other forces on the haptic thread than when computed again; the recording will not replay",
        status_.file.string(), report.disagreements);
  } else if (!report.fault.empty()) {
    status_.problem = fmt::format("{}: {}", status_.file.string(), report.fault);
  } else if (report.outcome == Outcome::technicalFailure) {
    status_.problem = source.statusText();
  }
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
