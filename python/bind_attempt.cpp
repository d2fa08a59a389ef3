// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>

#include "python/bindings.h"
#include "python/driven_attempt.h"
#include "python/places.h"
#include "recorder/engine/state_fields.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/performer.h"

namespace py = pybind11;

namespace calot::python {

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::span<const double> numbersOf(const Numbers& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

int stepOf(DrivenAttempt& attempt, const Numbers& action) {
  if (static_cast<std::size_t>(action.size()) != numbersOfAction)
    throw Error(ErrorKind::invalid,
                "an action has shape (2, 6): for the left and the right hand x, y, z, roll, jaw and buttons");
  const std::span<const double> numbers = numbersOf(action);
  return static_cast<int>(withoutLock([&] { return attempt.step(numbers); }));
}

py::tuple runOf(DrivenAttempt& attempt, const Numbers& actions) {
  if (static_cast<std::size_t>(actions.size()) % numbersOfAction != 0)
    throw Error(ErrorKind::invalid, "actions have shape (N, 2, 6): an action for each step");
  const std::span<const double> numbers = numbersOf(actions);
  Bytes rows;
  const std::size_t done = withoutLock([&] { return attempt.run(numbers, rows); });
  return py::make_tuple(done, bytesOf(rows));
}

void recordOf(DrivenAttempt& attempt, const std::filesystem::path& path, const std::string& controller,
              const std::string& version, const std::string& participant, const std::string& station,
              const std::string& purpose, const std::string& handedness, bool force) {
  recorder::AttemptSettings settings;
  settings.participant = participant;
  settings.station = station;
  settings.purpose = purpose;
  settings.handedness = handedness;
  withoutLock([&] { attempt.record(path, settings, recorder::controllerProvenance(controller, version), force); });
}

py::dict sceneOf(const DrivenAttempt& attempt) {
  const Model& model = attempt.model();
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
  recorder::AttemptSettings settings;
  settings.participant = participant;
  settings.purpose = purpose;
  settings.mode = mode == "assessment" ? recorder::Mode::assessment : recorder::Mode::practice;
  settings.seed = seed;
  recorder::RecordingWriter writer(
      path, recorder::makeHeader(model, std::move(loaded.assets), source->provenance(), settings), {force, {}});
  recorder::WorkerPool pool(1);
  recorder::Session session(model, seed, pool, {.compliances = &prepared->compliances()});
  session.join(writer);
  recorder::RunSettings run;
  run.seconds = seconds;
  const recorder::RunReport report = recorder::runAttempt(session, *source, run);
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
          "end", [](DrivenAttempt& a, int outcome) { a.end(static_cast<recorder::Outcome>(outcome)); }, "outcome"_a,
          py::call_guard<py::gil_scoped_release>())
      .def(
          "mount", [](DrivenAttempt& a, int hand, const std::string& name) { a.mount(static_cast<Hand>(hand), name); },
          "hand"_a, "name"_a)
      .def(
          "look",
          [](DrivenAttempt& a, const std::array<double, 7>& c) {
            a.look(Vec3(c[0], c[1], c[2]), Quat(c[3], c[4], c[5], c[6]));
          },
          "pose"_a)
      .def("moment", &DrivenAttempt::moment, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("action", &DrivenAttempt::action)
      .def_property_readonly("facts", [](const DrivenAttempt& a) { return StepFacts(a.facts()); })  // the step's own
      .def_property_readonly("columns",
                             [](const DrivenAttempt& a) { return columnList(recorder::resultColumns(a.model())); })
      .def_property_readonly("scene", sceneOf)
      .def_property_readonly("warnings", &DrivenAttempt::warnings)
      .def_property_readonly("steps", &DrivenAttempt::steps)
      .def_property_readonly("ended", &DrivenAttempt::ended)
      .def_property_readonly("outcome", [](const DrivenAttempt& a) { return static_cast<int>(a.outcome()); });
}

}  // namespace calot::python
