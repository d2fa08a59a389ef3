// SPDX-License-Identifier: GPL-3.0-or-later
// The module itself: what it consists of, where its files are, and C++ errors as Python's.
#include <dlfcn.h>

#include <exception>
#include <system_error>

#include "analytics/checkpoints/replay_words.h"
#include "python/bindings.h"
#include "recorder/base/files.h"
#include "recorder/base/remedy_words.h"
#include "recorder/compliance_cache.h"
#include "recorder/formats/scene_file.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "sim/instruments/instruments.h"
#include "sim/scene/step_result.h"
#include "sim/scene/version.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// A recording that is not what its re-simulation gives: diverged.
struct ReplayFault : Error {
  explicit ReplayFault(const recorder::ReplayReport& of)
      : Error(ErrorKind::refused, Where{of.path.string()}, analytics::wordsFor(of), of.remedies), report(of) {}
  recorder::ReplayReport report;
};

/// Remedies that are an argument of a function.
constexpr RemedyWords remedyArguments[] = {
    {Remedy::replaceExisting, "force=True replaces what is there"},
    {Remedy::replayAnyway, "anyway=True repeats it all the same"},
};

py::dict about(const Error& e) {
  const int exitCode = static_cast<int>(e.kind()) + 1;  // of the command line (docs/reference/command-line.md)
  return py::dict("exit_code"_a = exitCode, "file"_a = e.where().file, "place"_a = e.where().place,
                  "advice"_a = adviceText(e.remedies(), remedyArguments));
}

void raise(const Error& e, py::dict details) {
  const auto text = details["advice"].cast<std::string>();
  const std::string message = text.empty() ? std::string(e.what()) : std::string(e.what()) + "; " + text;
  const py::object error = py::module_::import("calot._errors").attr("error_of")(message, std::move(details));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const ReplayFault& e) {
    py::dict details = about(e);
    const auto& divergence = e.report.divergence;
    if (divergence) {
      details["step"] = divergence->step;
      details["tick"] = divergence->tick;
      details["component"] = divergence->component;
      details["field"] = divergence->field;
      details["detail"] = divergence->detail;
    }
    details["diverged"] = true;
    raise(e, std::move(details));
  } catch (const Error& e) {
    raise(e, about(e));
  }
}

/// Folder of the programs: `bin` of the nearest folder above the module that has engines or assets; empty: none.
std::filesystem::path programFolder() {
  static const char here = 0;
  Dl_info info{};
  if (dladdr(&here, &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code ignored;
  const std::filesystem::path module = std::filesystem::absolute(info.dli_fname, ignored);
  for (std::filesystem::path at = module.parent_path(); at.has_relative_path(); at = at.parent_path()) {
    const bool built = std::filesystem::exists(at / "bin/calot-engine", ignored);
    if (built || std::filesystem::is_directory(at / "share/calot", ignored)) return at / "bin";
  }
  return {};
}

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

std::vector<std::filesystem::path> assetFolders() { return recorder::ProgramFiles(programFolder()).assetRoots(); }

void throwUnlessExact(const recorder::ReplayReport& report) {
  if (report.verdict == recorder::ReplayVerdict::diverged) throw ReplayFault(report);
  if (const std::optional<ErrorKind> fault = report.fault())
    throw Error(*fault, Where{report.path.string()}, analytics::wordsFor(report), report.remedies);
}

}  // namespace calot::python

PYBIND11_MODULE(_calot, m) {
  using namespace calot;
  m.doc() = "The libraries of Calot. Use the package calot, which makes arrays of what this hands over.";
  py::register_exception_translator(python::translate);
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
