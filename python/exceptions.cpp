// SPDX-License-Identifier: GPL-3.0-or-later
#include <exception>

#include "analytics/checkpoints/replay_words.h"
#include "python/bindings.h"
#include "recorder/base/remedy_words.h"

namespace py = pybind11;

namespace calot::python {

namespace {

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
    const auto& divergence = e.report().divergence;
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

}  // namespace

ReplayFault::ReplayFault(const recorder::ReplayReport& report)
    : Error(ErrorKind::refused, Where{report.path.string()}, analytics::wordsFor(report), report.remedies),
      report_(report) {}

void throwUnlessExact(const recorder::ReplayReport& report) {
  if (report.verdict == recorder::ReplayVerdict::diverged) throw ReplayFault(report);
  if (const std::optional<ErrorKind> fault = report.fault())
    throw Error(*fault, Where{report.path.string()}, analytics::wordsFor(report), report.remedies);
}

void translateErrors() { py::register_exception_translator(translate); }

}  // namespace calot::python
