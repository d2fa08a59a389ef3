// SPDX-License-Identifier: GPL-3.0-or-later
// calot-trainer: options, then the window.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <QApplication>
#include <QDeadlineTimer>
#include <QTimer>
#include <string>
#include <utility>

#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/cohort_database.h"
#include "apps/calot/environment.h"
#include "apps/calot/source_options.h"
#include "apps/common/program.h"
#include "apps/window/window_start.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/end_page.h"
#include "gui/trainer/operation_view.h"
#include "gui/trainer/run_panel.h"
#include "gui/trainer/trainer_window.h"
#include "gui/trainer/training_session.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/compliance_cache.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

struct Options {
  SourceOptions source;
  std::string scene, participant, station, stationKey, purpose = "training", handedness = "unknown", folder = ".";
  std::string mode = "practice", pictures, graphics = "auto", cohort, broadPhase = "grid";
  std::string parent, at;  ///< of a branch
  LookOptions look;
  bool aloud = false;
  std::uint64_t seed = 1;
  double seconds = 0.0;
  unsigned threads = 1;
};

/// The parser alone takes "nan" and "inf". @return empty, or the fault
std::string positiveSeconds(const std::string& text) {
  char* end = nullptr;
  const double seconds = std::strtod(text.c_str(), &end);
  const bool whole = end != text.c_str() && *end == '\0';
  return whole && std::isfinite(seconds) && seconds > 0.0
             ? std::string()
             : fmt::format("'{}' is not a number of seconds above 0", text);
}

void add(CLI::App& app, Options& o) {
  app.set_version_flag("--version", recorder::softwareName());
  app.footer("Example:\n  calot-trainer --participant P1 --cohort c.db -o recordings");
  app.add_option("--scene", o.scene,
                 "name of a scene (calot scenes), or a scene file; without one, the window offers them");
  auto* const branch = app.add_option("--branch", o.parent, "go on with this recording, from the moment --at")
                           ->excludes(app.get_option("--scene"));
  auto* const at =
      app.add_option("--at", o.at, "where the branch leaves it: seconds (12.5) or minutes and seconds (1:02.5)");
  at->needs(branch);
  branch->needs(at);
  auto* const device =
      app.add_option("--device", o.source.device.name, recorder::deviceUsage() + "; default: mouse and keyboard");
  app.add_option("--performer", o.source.performer,
                 "watch a synthetic operator: skilled, intermediate, unskilled, or a file")
      ->excludes(device);
  addTools(app, o.source.device);
  addScope(app, o.source.scope);
  app.add_option("--calibration", o.source.device.calibration,
                 "of the device, or of mouse and keyboard; an assessment needs one");
  app.add_option("--participant", o.participant, "pseudonym")->transform(CLI::Validator(pseudonymForm, ""));
  app.add_option("--mode", o.mode, "practice or assessment: no hints, no pause, no going back")
      ->check(CLI::IsMember({"practice", "assessment"}))
      ->capture_default_str();
  app.add_option("--purpose", o.purpose, "training, study, demo")
      ->check(CLI::IsMember({"training", "study", "demo"}))
      ->capture_default_str();
  app.add_option("--handedness", o.handedness, "right, left, unknown")
      ->check(CLI::IsMember({"right", "left", "unknown"}))
      ->capture_default_str();
  app.add_option("--station", o.station, "name of this training station");
  addStationKey(app, o.stationKey);
  app.add_option("--seed", o.seed, "of simulation and performer")->check(wholeNumber)->capture_default_str();
  addBroadPhase(app, o.broadPhase);
  app.add_option("--threads", o.threads, "of the simulation; 0: all")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  app.add_option("--seconds", o.seconds, "end when an attempt has run so long, and print how smooth it was")
      ->check(positiveSeconds);
  app.add_option("-o,--output", o.folder, "folder for the recordings")->capture_default_str();
  app.add_option(
      "--cohort", o.cohort,
      "cohort database that attempts are put into, and whose norms and earlier attempts they are held against; "
      "made where it is not there");
  app.add_flag("--aloud", o.aloud, "what the panel asks for and says is read aloud, too");
  addLook(app, o.look, "system, 100");
  addGraphics(app, o.graphics);
  app.add_option("--pictures", o.pictures, "Write a PNG of each page into this folder, and end");
}

/// A device of the command line, or a performer to be watched, as the trainer's source. Each attempt opens it again.
class OptionsInput final : public gui::AttemptInput {
 public:
  /// @param seed of a performer
  OptionsInput(SourceOptions options, std::uint64_t seed) : options_(std::move(options)), seed_(seed) {}

  /// @throws Error as makeSource
  std::unique_ptr<recorder::SampleSource> open(const SceneDescription& scene) override {
    return makeSource(options_, scene, seed_);
  }
  void drive(recorder::SampleSource& source, recorder::RunSettings& run) override { driveDevice(source, run); }
  void setMode(recorder::Mode mode, const std::filesystem::path& calibration) override {
    SourceOptions wanted = options_;
    wanted.mode = mode;
    if (!calibration.empty()) wanted.device.calibration = calibration.string();
    if (wanted.performer.empty()) static_cast<void>(makeSource(wanted, SceneDescription{}, seed_));  // its faults
    options_ = std::move(wanted);
  }

 private:
  SourceOptions options_;
  std::uint64_t seed_;
};

/// A cohort that cannot be opened is reported before there is a window; a missing one is made when it is needed.
std::filesystem::path cohortOf(const std::string& cohort) {
  if (cohort.empty()) return {};
  std::error_code ignored;
  if (std::filesystem::exists(cohort, ignored))
    static_cast<void>(analytics::CohortDatabase(cohort, analytics::CohortDatabase::Access::read));
  else
    requireFolder(std::filesystem::absolute(cohort).parent_path().string(), "the cohort");
  return cohort;
}

/// Every fault of the command line is reported here, before there is a window.
gui::TrainerSetup setUp(const Options& o, const std::optional<recorder::LoadedScene>& scene) {
  requireFolder(o.folder, "recordings");
  if (!o.pictures.empty()) requireFolder(o.pictures, "pictures");
  gui::TrainerSetup setup;
  setup.settings.key = stationKeyOf(o.stationKey);
  const recorder::Mode mode = o.mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice;
  setup.settings.attempt = {o.participant, stationOf(o.station, setup.settings.key), o.purpose, o.handedness, mode,
                            o.seed};
  setup.settings.folder = o.folder;
  // Pictures and timings are taken where nobody moves a hand, and no hand is at the null device.
  setup.settings.fromFirstMotion = o.pictures.empty() && o.seconds == 0.0 && o.source.device.name != "null";
  setup.cohort = cohortOf(o.cohort);
  SourceOptions performer;
  performer.performer = "skilled";
  setup.demonstration = std::make_shared<OptionsInput>(std::move(performer), o.seed);
  setup.settings.threads = o.threads;
  setup.settings.makeBroadPhase = broadPhaseOf(o.broadPhase);
  SourceOptions who = o.source;
  refuseScope(who.scope);
  if (who.scope.moves() && who.scope.device.empty() && who.performer.empty())
    setup.scope = who.scope.keys = std::make_shared<recorder::ScopeInput>();
  if (!who.performer.empty() && !who.device.calibration.empty())
    throw Error(ErrorKind::invalid, "--calibration needs a device; a performer takes none");
  who.mode = mode;
  if (who.device.name.empty() && who.performer.empty()) {
    setup.mouse = std::make_shared<recorder::MouseInput>();
    gui::MouseAttemptInput::AddScope addScope;
    if (who.scope.moves()) {
      addScope = [scope = who.scope](std::unique_ptr<recorder::SampleSource> source, const SceneDescription& of) {
        return withScope(std::move(source), scope, of, {}, 0);
      };
    }
    setup.input = std::make_shared<gui::MouseAttemptInput>(setup.mouse, addScope);
    if (o.source.device.calibration.empty() && mode == recorder::Mode::assessment) {
      throw Error(ErrorKind::invalid,
                  "--mode assessment: mouse and keyboard need a --calibration (calot devices calibrate mouse --pixel "
                  "declares one), or name a --device and its own");
    }
    setup.input->setMode(mode, o.source.device.calibration);
  } else {
    auto input = std::make_shared<OptionsInput>(who, o.seed);
    // Its faults are reported now. A performer needs a scene; a device is there or not whatever the scene.
    if (scene || who.performer.empty()) static_cast<void>(input->open(scene ? scene->description : SceneDescription{}));
    setup.input = std::move(input);
  }
  return setup;
}

std::optional<recorder::LoadedScene> sceneOf(const std::string& name) {
  if (name.empty()) return std::nullopt;
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(name, assetFolders()));
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "calot-trainer: warning: {}\n", warning);
  static_cast<void>(recorder::prepareScene(scene.assets, Where{"scene " + name}));  // faults before a window
  return scene;
}

/// Runs the window until `there`, or until `seconds` are over. @returns there()
bool waitFor(const std::function<bool()>& there, int seconds) {
  const QDeadlineTimer limit(1000LL * seconds);
  while (!there() && !limit.hasExpired()) QApplication::processEvents(QEventLoop::WaitForMoreEvents, 20);
  return there();
}

/// Writes a picture of each page into a folder: greeting.png and, with a scene, controls.png, running.png, paused.png
/// (after the first mistake, or a minute) and end.png. Lives in real time; what it records lies in the setup's folder.
/// @throws Error (failure) where nothing comes on the screen, or a picture cannot be written
void takePictures(gui::TrainerWindow& window, std::optional<recorder::LoadedScene> scene, const std::string& folder) {
  const auto save = [&](const char* name) {
    window.refresh();
    gui::parts::savePicture(window, QString::fromStdString(folder + "/" + name + ".png"));
  };
  const auto wanted = [](bool there, const char* what) {
    if (!there) throw Error(ErrorKind::failure, std::string("--pictures: ") + what);
  };
  window.chooseScene();
  waitFor([] { return false; }, 1);  // the history is being read
  save("greeting");
  if (!scene) return;
  const auto status = [&] { return window.session()->status(); };
  const auto runs = [&] {
    const quint64 shown = window.view()->shown();
    return waitFor([&] { return status().figures.time > 4.0 && window.view()->shown() > shown + 10; }, 240);
  };
  window.begin(*scene, gui::Purpose::controls);
  wanted(runs(), "nothing is running");
  save("controls");
  window.begin(std::move(*scene));
  wanted(runs(), "nothing is running");
  save("running");
  waitFor([&] { return !status().figures.errors->empty(); }, 60);
  waitFor([] { return false; }, 1);  // what comes of it
  if (window.session()->pause()) {
    waitFor([] { return false; }, 1);  // the last pictures are still being drawn
    save("paused");
    window.session()->resume();
  }
  window.session()->finish();
  wanted(waitFor([&] { return status().stage == gui::Stage::ended; }, 30), "the attempt does not end");
  window.refresh();
  waitFor([&] { return window.endPage()->replay().isOpen() && window.endPage()->settled(); }, 240);
  save("end");
}

gui::TrainerWindow* shown = nullptr;
QtMessageHandler usualMessages = nullptr;

/// If the display goes away, Qt says so and calls exit() in the middle of its work, beside threads that draw, record
/// and simulate. What runs ends first, so that its recording is whole; what is left is not worth being taken apart.
void onMessage(QtMsgType type, const QMessageLogContext& context, const QString& message) {
  if (shown == nullptr || !message.contains("connection broke")) return usualMessages(type, context, message);
  for (const std::string& line : shown->endAndReport()) fmt::print("{}\n", line);
  fmt::print(stderr, "calot-trainer: the display is gone: {}\n", message.toStdString());
  std::fflush(nullptr);
  std::_Exit(static_cast<int>(ExitCode::failure));
}

/// A recording to go on with, and its scene.
struct Parent {
  std::filesystem::path file;
  double time = 0.0;  ///< s
  recorder::LoadedScene scene;
};

/// Its faults are reported before there is a window.
std::optional<Parent> parentOf(const Options& o) {
  if (o.parent.empty()) return std::nullopt;
  if (o.mode == "assessment") throw Error(ErrorKind::invalid, "--branch: an assessment has no branches; practise it");
  const recorder::ChainVerdict chain = recorder::probe(o.parent);
  const recorder::Recording recording(o.parent);
  analytics::refuseBrokenParent(o.parent, chain);
  recorder::refuseParent(recording);
  Parent parent{o.parent, parseTime(o.at), recorder::sceneFromAssets(recording.header().assets)};
  static_cast<void>(recorder::forkStepAt(recording, parent.time));
  return parent;
}

int run(const Options& o, int argc, char** argv) {
  stopOnSignals();
  recorder::useComplianceCache(recorder::userCacheFolder());
  const recorder::ProgramFiles files = recorder::ProgramFiles::ofThisProgram();
  recorder::useEngines(recorder::userEnginePlaces(files.programs(), files.assetRoots()));
  std::optional<Parent> parent = parentOf(o);
  std::optional<recorder::LoadedScene> scene = parent ? std::move(parent->scene) : sceneOf(o.scene);
  gui::TrainerSetup setup = setUp(o, scene);
  std::vector<std::string> faults;
  if (!scene || !o.pictures.empty()) setup.scenes = gui::sceneChoices(assetFolders(), faults);
  for (const std::string& fault : faults) fmt::print(stderr, "calot-trainer: {}\n", fault);
  if (!scene && setup.scenes.empty())
    throw Error(ErrorKind::invalid, "no scenes were found; set CALOT_ASSETS to the folder that holds \"scenes\"");
  const std::optional<QSize> asked = windowSize(o.look);
  const std::unique_ptr<QApplication> application = openScreen(argc, argv);
  useGraphics(o.graphics);
  gui::theme::apply(gui::theme::choiceOf(QString::fromStdString(o.look.colours)),
                    o.look.type == 0 ? gui::theme::usualType : o.look.type);
  if (o.aloud) {
    if (const QString fault = gui::Voice().fault(); !fault.isEmpty())
      throw Error(ErrorKind::failure, "--aloud: " + fault.toStdString());
  }
  gui::TrainerWindow window(std::move(setup));
  if (o.aloud) window.setAloud(true);
  if (asked) window.resize(*asked);
  window.show();
  if (!o.pictures.empty()) {
    takePictures(window, std::move(scene), o.pictures);
    return 0;
  }
  if (parent)
    window.beginBranch(std::move(*scene), parent->file, parent->time);
  else if (scene)
    window.begin(std::move(*scene));
  QTimer asking;
  QObject::connect(&asking, &QTimer::timeout, &window, [&window, seconds = o.seconds] {
    const bool over =
        seconds > 0.0 && window.session() != nullptr && window.session()->status().figures.time >= seconds;
    if (over || stopRequested()) window.close();
  });
  asking.start(100);
  shown = &window;
  usualMessages = qInstallMessageHandler(nullptr);  // known before another thread may say something
  qInstallMessageHandler(onMessage);
  const int code = QApplication::exec();
  shown = nullptr;
  for (const std::string& line : window.endAndReport()) fmt::print("{}\n", line);
  return code;
}

}  // namespace
}  // namespace calot::apps

int main(int argc, char** argv) {
  CLI::App app{"Practises or assesses an operation, live: every attempt is recorded.", "calot-trainer"};
  calot::apps::Options o;
  calot::apps::add(app, o);
  return calot::apps::runProgram(app, argc, argv, [&] { return calot::apps::run(o, argc, argv); });
}
