// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/errors.h"

#include <pybind11/pybind11.h>

#include <exception>

#include "apps/common/advice.h"
#include "apps/common/exit_code.h"

namespace py = pybind11;

namespace calot::python {

namespace {

py::dict about(const Error& e) {
  py::dict d;
  d["exit_code"] = static_cast<int>(apps::codeOf(e.kind()));
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
    if (!text.empty()) text += ", or ";
    text += remedy == Remedy::replaceExisting ? "force=True replaces what is there" : apps::advice({remedy});
  }
  return text;
}

void translateErrors() { py::register_exception_translator(translate); }

}  // namespace calot::python
