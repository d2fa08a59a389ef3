// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/exceptions.h"

#include <pybind11/pybind11.h>

#include <exception>

namespace py = pybind11;

namespace calot::python {

namespace {

/// Exit code of the command line (docs/reference/command-line.md).
int exitCodeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::failure:
      return 1;
    case ErrorKind::invalid:
      return 2;
    case ErrorKind::refused:
      return 3;
    case ErrorKind::damaged:
      return 4;
    case ErrorKind::undecided:
      return 5;
  }
  return 1;
}

/// Remedies that the module's functions can ask for; the others are of commands that it has not.
const char* wordsOf(Remedy remedy) {
  switch (remedy) {
    case Remedy::replaceExisting:
      return "force=True replaces what is there";
    case Remedy::replayAnyway:
      return "anyway=True repeats it all the same";
    case Remedy::recover:
      return "calot recover saves what it can";
    case Remedy::installEngine:
      return "calot engine list shows those that are there";
    case Remedy::measureCalibration:
      return "measure again with calot devices calibrate";
    case Remedy::addParticipant:
      return "register one with calot participant add";
    case Remedy::changeParticipant:
      return "change it with calot participant set";
    case Remedy::upgradeCohort:
      return "bring it there with calot cohort upgrade, which keeps a copy";
    case Remedy::emptyLog:
      return "end that program and run calot cohort scrub";
    case Remedy::importAgain:
      return "run calot import on its file";
    case Remedy::assessAgain:
      return "assess the older recordings again";
    default:
      return "";
  }
}

py::dict about(const Error& e) {
  py::dict d;
  d["exit_code"] = exitCodeOf(e.kind());
  d["file"] = e.where().file;
  d["place"] = e.where().place;
  d["advice"] = advice(e.remedies());
  return d;
}

void raise(const Error& e, py::dict details) {
  const std::string text = advice(e.remedies());
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
      details["tick"] = divergence->tick ? py::object(py::int_(*divergence->tick)) : py::object(py::none());
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
    : Error(ErrorKind::refused, Where{report.path.string()}, report.message, report.remedies), report_(report) {}

void throwUnlessExact(const recorder::ReplayReport& report) {
  if (report.verdict == recorder::ReplayVerdict::diverged) throw ReplayFault(report);
  if (const std::optional<ErrorKind> fault = report.fault())
    throw Error(*fault, Where{report.path.string()}, report.message, report.remedies);
}

std::string advice(const std::vector<Remedy>& remedies) {
  std::string text;
  for (const Remedy remedy : remedies) {
    const std::string words = wordsOf(remedy);
    if (!text.empty() && !words.empty()) text += ", or ";
    text += words;
  }
  return text;
}

void translateErrors() { py::register_exception_translator(translate); }

}  // namespace calot::python
