// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <cmath>
#include <span>

#include "python/bindings.h"
#include "python/moment.h"
#include "python/step_facts.h"
#include "recorder/base/text_words.h"
#include "recorder/engine/state_fields.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/performer.h"
#include "sim/instruments/instruments.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// x, y, z (m), roll (rad), jaw (rad), buttons (bits) of a hand.
constexpr std::size_t numbersOfHand = 6, numbersOfAction = numbersOfHand * handCount;

/// An attempt that Python advances by rows of numbers. May be used by several threads, one at a time.
struct DrivenAttempt {
  /// @param name of a scene, or its file @throws Error as recorder::findScene(), loadScene() and prepareScene()
  DrivenAttempt(const std::string& name, std::uint64_t seed)
      : loaded(recorder::loadScene(recorder::findScene(name, assetFolders()))),
        scene(recorder::prepareScene(loaded.assets, Where{"scene " + name})),
        facts(scene->model().scene()),
        attempt(scene, loaded.assets, seed) {
    for (std::size_t h = 0; h < handCount; ++h) mounted[h] = attempt.hands()[h].instrument;
    attempt.join(facts);
  }

  std::mutex mutex;
  recorder::LoadedScene loaded;
  std::shared_ptr<recorder::PreparedScene> scene;
  FactsObserver facts;  // the attempt has to end before it
  recorder::StepwiseAttempt attempt;
  std::array<InstrumentKind, handCount> mounted{};
};

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::span<const double> numbersOf(const Numbers& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

constexpr double allButtons = 63.0;

/// Rounded: actions that are drawn at random are no whole numbers.
std::uint8_t buttonsOf(double number, const char* hand) {
  if (!(number >= 0.0 && number <= allButtons))
    throw Error(ErrorKind::invalid,
                fmt::format("the {} hand's command: its buttons are {}; give the sum of 1 cut, 2 coagulation, 4 fire, "
                            "8 lock, 16 and 32 retract more and less",
                            hand, number));
  return static_cast<std::uint8_t>(std::lround(number));
}

recorder::HandCommands commandsOf(const DrivenAttempt& driven, std::span<const double> action) {
  recorder::HandCommands commands;
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::span<const double> own = action.subspan(h * numbersOfHand, numbersOfHand);
    commands[h] = {Vec3(own[0], own[1], own[2]), own[3], own[4], buttonsOf(own[5], handNames[h]), driven.mounted[h]};
  }
  return commands;
}

int stepOf(DrivenAttempt& driven, const Numbers& action) {
  if (static_cast<std::size_t>(action.size()) != numbersOfAction)
    throw Error(ErrorKind::invalid,
                "an action has shape (2, 6): for the left and the right hand x, y, z, roll, jaw and buttons");
  const std::span<const double> numbers = numbersOf(action);
  return static_cast<int>(alone(driven.mutex, [&] { return driven.attempt.step(commandsOf(driven, numbers)); }));
}

/// Steps until the actions are used up or the attempt is over. @returns how many steps were done, with a row of results
/// of each
py::tuple runOf(DrivenAttempt& driven, const Numbers& actions) {
  if (static_cast<std::size_t>(actions.size()) % numbersOfAction != 0)
    throw Error(ErrorKind::invalid, "actions have shape (N, 2, 6): an action for each step");
  std::span<const double> rest = numbersOf(actions);
  Bytes rows;
  const std::size_t done = alone(driven.mutex, [&] {
    std::size_t steps = 0;
    recorder::Outcome outcome = driven.attempt.outcome();
    for (; !rest.empty() && outcome == recorder::Outcome::running; ++steps) {
      outcome = driven.attempt.step(commandsOf(driven, rest.first(numbersOfAction)));
      rest = rest.subspan(numbersOfAction);
      const Bytes& row = driven.facts.facts().row;
      rows.insert(rows.end(), row.begin(), row.end());
    }
    return steps;
  });
  return py::make_tuple(done, bytesOf(rows));
}

void recordOf(DrivenAttempt& driven, const std::filesystem::path& path, const std::string& controller,
              const std::string& version, const std::string& participant, const std::string& station,
              const std::string& purpose, const std::string& handedness, bool force) {
  alone(driven.mutex, [&] {
    driven.attempt.record(path, {participant, station, purpose, handedness},
                          recorder::controllerProvenance(controller, version), {force, {}});
  });
}

/// @param name of an instrument, or "none" @throws Error (invalid)
void mount(DrivenAttempt& driven, int hand, const std::string& name) {
  const InstrumentDefinition* const found = findInstrument(name);
  if (found == nullptr && name != "none") {
    std::string known = "none";
    for (const InstrumentDefinition* each : instruments()) known += std::string(", ") + each->name;
    throw Error(ErrorKind::invalid,
                fmt::format("there is no instrument \"{}\"; there are {}", recorder::shown(name), known));
  }
  alone(driven.mutex, [&] {
    driven.mounted[static_cast<std::size_t>(hand)] = found == nullptr ? InstrumentKind::none : found->kind;
  });
}

/// @param pose position and quaternion (w x y z) @throws Error (invalid)
void look(DrivenAttempt& driven, const std::array<double, 7>& pose) {
  const Vec3 position(pose[0], pose[1], pose[2]);
  const Quat orientation(pose[3], pose[4], pose[5], pose[6]);
  if (!position.allFinite() || !(std::abs(orientation.norm() - 1.0) <= 1e-6))
    throw Error(ErrorKind::invalid, "the camera: a finite position and a unit quaternion w, x, y, z are expected");
  alone(driven.mutex, [&] { driven.attempt.look({position, orientation}); });
}

Moment momentOf(DrivenAttempt& driven) {
  return alone(driven.mutex, [&] { return Moment{driven.attempt.view(), {}, {}, {}, {}}; });
}

/// Commands that would leave the hands as they are.
std::vector<double> actionOf(DrivenAttempt& driven) {
  std::vector<double> numbers;
  for (const recorder::HandCommand& hand : alone(driven.mutex, [&] { return driven.attempt.hands(); })) {
    for (const double v : {hand.tip.x(), hand.tip.y(), hand.tip.z(), hand.roll, hand.jaw}) numbers.push_back(v);
    numbers.push_back(static_cast<double>(hand.buttons));
  }
  return numbers;
}

py::dict sceneOf(const DrivenAttempt& driven) {
  const Model& model = driven.scene->model();
  const SceneDescription& scene = model.scene();
  py::list structures, ports, homes, workspace;
  for (const StructureModel& s : model.structures()) structures.append(s.name);
  for (const HandDescription& hand : scene.hands) {
    ports.append(py::make_tuple(hand.port.x(), hand.port.y(), hand.port.z()));
    homes.append(py::make_tuple(hand.home.x(), hand.home.y(), hand.home.z()));
  }
  for (const Vec3& corner : scene.workspace) workspace.append(py::make_tuple(corner.x(), corner.y(), corner.z()));
  py::list observed;
  for (const ObservedPart& part : observedParts) {
    py::tuple shape = py::make_tuple(handCount, part.width);
    if (part.width == structureWidth) shape = py::make_tuple(handCount, model.structures().size());
    if (part.width == 1) shape = py::make_tuple(handCount);
    if (part.width == 0) shape = py::make_tuple(1);
    observed.append(py::make_tuple(part.name, part.unit, shape));
  }
  return py::dict("name"_a = scene.name, "major"_a = scene.majorVersion, "minor"_a = scene.minorVersion,
                  "tick_seconds"_a = tickLength, "ticks_per_step"_a = scene.ticksPerStep,
                  "time_limit"_a = scene.timeLimit, "procedure"_a = !scene.procedure.specimen.empty(),
                  "observed"_a = observed, "structures"_a = structures, "ports"_a = ports, "homes"_a = homes,
                  "workspace"_a = workspace);
}

/// Records a performer, as `calot record`. @returns outcome, seconds
std::pair<std::string, double> record(const std::filesystem::path& path, const std::string& scene,
                                      const std::string& performer, std::uint64_t seed, double seconds,
                                      const std::string& participant, const std::string& purpose,
                                      const std::string& mode, bool force) {
  const py::gil_scoped_release release;
  recorder::LoadedScene loaded = recorder::loadScene(recorder::findScene(scene, assetFolders()));
  const std::shared_ptr<recorder::PreparedScene> prepared =
      recorder::prepareScene(loaded.assets, Where{"scene " + scene});
  const Model& model = prepared->model();
  const auto source = recorder::makePerformer(
      recorder::loadPerformer(recorder::findPerformer(performer, assetFolders())), model.scene(), seed);
  const recorder::AttemptSettings settings{
      .participant = participant,
      .purpose = purpose,
      .mode = mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice,
      .seed = seed};
  recorder::RecordingWriter writer(
      path, recorder::makeHeader(model, std::move(loaded.assets), source->provenance(), settings), {force, {}});
  recorder::WorkerPool pool(1);
  recorder::Session session(model, seed, pool, {.compliances = &prepared->compliances()});
  session.join(writer);
  const recorder::RunReport report = recorder::runAttempt(session, *source, {.seconds = seconds});
  writer.finish();
  prepared->save();
  return {recorder::wordFor(report.outcome), static_cast<double>(report.steps) * model.stepSeconds()};
}

}  // namespace

void bindAttempt(py::module_& m) {
  m.def("record", record, "path"_a, "scene"_a, "performer"_a, "seed"_a, "seconds"_a, "participant"_a, "purpose"_a,
        "mode"_a, "force"_a);
  py::class_<DrivenAttempt>(m, "Attempt", "An attempt that its caller advances.")
      .def(py::init<const std::string&, std::uint64_t>(), "scene"_a, "seed"_a, py::call_guard<py::gil_scoped_release>())
      .def("step", stepOf, "action"_a)
      .def("run", runOf, "actions"_a)
      .def("record", recordOf, "path"_a, "controller"_a, "version"_a, "participant"_a, "station"_a, "purpose"_a,
           "handedness"_a, "force"_a)
      .def(
          "end",
          [](DrivenAttempt& a, int outcome) {
            alone(a.mutex, [&] { a.attempt.end(static_cast<recorder::Outcome>(outcome)); });
          },
          "outcome"_a)
      .def("mount", mount, "hand"_a, "name"_a)
      .def("look", look, "pose"_a)
      .def("moment", momentOf)
      .def_property_readonly("action", actionOf)
      .def_property_readonly("facts", [](const DrivenAttempt& a) { return a.facts.facts(); })  // a copy: the step's own
      .def_property_readonly(
          "columns", [](const DrivenAttempt& a) { return columnList(recorder::resultColumns(a.scene->model())); })
      .def_property_readonly("scene", sceneOf)
      .def_property_readonly("warnings", [](const DrivenAttempt& a) { return a.loaded.warnings; })
      .def_property_readonly("steps", [](const DrivenAttempt& a) { return a.attempt.steps(); })
      .def_property_readonly("ended", [](const DrivenAttempt& a) { return a.attempt.ended(); })
      .def_property_readonly("outcome", [](const DrivenAttempt& a) { return static_cast<int>(a.attempt.outcome()); });
}

}  // namespace calot::python
