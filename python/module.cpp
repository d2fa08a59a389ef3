// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include "python/bindings.h"
#include "python/places.h"
#include "recorder/compliance_cache.h"
#include "recorder/formats/scene_file.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "sim/instruments/instruments.h"
#include "sim/scene/step_result.h"
#include "sim/scene/version.h"

namespace py = pybind11;

namespace calot::python {

namespace {

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const std::filesystem::path& file : recorder::listScenes(assetFolders())) names.push_back(file.stem().string());
  return names;
}

py::dict instrumentNumbers() {
  py::dict numbers;
  numbers[instrument::none.name] = 0;
  for (const InstrumentDefinition* definition : instruments())
    numbers[definition->name] = static_cast<int>(definition->kind);
  return numbers;
}

}  // namespace

}  // namespace calot::python

PYBIND11_MODULE(_calot, m) {
  using namespace calot;
  m.doc() = "The libraries of Calot. Use the package calot, which makes arrays of what this hands over.";
  python::translateErrors();
  recorder::useComplianceCache(recorder::userCacheFolder());
  recorder::useEngines(recorder::userEnginePlaces(python::programFolder(), python::assetFolders()));
  m.attr("software") = recorder::softwareName();
  m.attr("build") = recorder::buildName();
  m.attr("simulation_version") = simulationVersion;
  m.attr("step_result_version") = stepResultVersion;
  m.def("scenes", python::sceneNames, "Names of the scenes that are installed.");
  m.def("instruments", python::instrumentNumbers, "Numbers of the instruments by their names.");
  python::bindRecording(m);
  python::bindReplay(m);
  python::bindMoment(m);
  python::bindCohort(m);
  python::bindAttempt(m);
}
