// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>

#include "python/bindings.h"
#include "python/driven_attempt.h"
#include "recorder/base/errors.h"
#include "recorder/engine/state_fields.h"

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
  const py::gil_scoped_release release;
  return static_cast<int>(attempt.step(numbers));
}

py::tuple runOf(DrivenAttempt& attempt, const Numbers& actions) {
  if (static_cast<std::size_t>(actions.size()) % numbersOfAction != 0)
    throw Error(ErrorKind::invalid, "actions have shape (N, 2, 6): an action for each step");
  const std::span<const double> numbers = numbersOf(actions);
  Bytes rows;
  std::size_t done = 0;
  {
    const py::gil_scoped_release release;
    done = attempt.run(numbers, rows);
  }
  return py::make_tuple(done, bytesOf(rows));
}

void recordOf(DrivenAttempt& attempt, const std::filesystem::path& path, const std::string& controller,
              const std::string& version, const std::string& participant, const std::string& station,
              const std::string& purpose, const std::string& handedness, bool force) {
  RecordWish wish;
  wish.target = path;
  wish.controller = controller;
  wish.version = version;
  wish.settings.participant = participant;
  wish.settings.station = station;
  wish.settings.purpose = purpose;
  wish.settings.handedness = handedness;
  wish.force = force;
  const py::gil_scoped_release release;
  attempt.record(wish);
}

py::dict sceneOf(const DrivenAttempt& attempt) {
  const Model& model = attempt.model();
  const SceneDescription& scene = model.scene();
  py::dict d;
  d["name"] = scene.name;
  d["major"] = scene.majorVersion;
  d["minor"] = scene.minorVersion;
  d["tick_seconds"] = tickLength;
  d["ticks_per_step"] = scene.ticksPerStep;
  d["time_limit"] = scene.timeLimit;
  d["procedure"] = !scene.procedure.specimen.empty();
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
  d["observed"] = observed;
  d["structures"] = structures;
  d["ports"] = ports;
  d["homes"] = homes;
  d["workspace"] = workspace;
  return d;
}

}  // namespace

void bindAttempt(py::module_& m) {
  py::class_<DrivenAttempt>(m, "Attempt", "An attempt that its caller advances.")
      .def(py::init<const std::string&, std::uint64_t>(), py::arg("scene"), py::arg("seed"),
           py::call_guard<py::gil_scoped_release>())
      .def("step", stepOf, py::arg("action"))
      .def("run", runOf, py::arg("actions"))
      .def("record", recordOf, py::arg("path"), py::arg("controller"), py::arg("version"), py::arg("participant"),
           py::arg("station"), py::arg("purpose"), py::arg("handedness"), py::arg("force"))
      .def(
          "end", [](DrivenAttempt& a, int outcome) { a.end(static_cast<recorder::Outcome>(outcome)); },
          py::arg("outcome"), py::call_guard<py::gil_scoped_release>())
      .def(
          "mount", [](DrivenAttempt& a, int hand, const std::string& name) { a.mount(static_cast<Hand>(hand), name); },
          py::arg("hand"), py::arg("name"))
      .def(
          "look",
          [](DrivenAttempt& a, const std::array<double, 7>& c) {
            a.look(Vec3(c[0], c[1], c[2]), Quat(c[3], c[4], c[5], c[6]));
          },
          py::arg("pose"))
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
