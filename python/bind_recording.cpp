// SPDX-License-Identifier: GPL-3.0-or-later

#include <optional>
#include <string>

#include "analytics/checkpoints/replay_words.h"
#include "python/bindings.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/recorded_columns.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// A recording that was probed and opened. May be used by several threads, one at a time.
struct OpenedRecording {
  explicit OpenedRecording(const std::filesystem::path& path) : chain(recorder::probe(path)), recording(path) {}

  std::mutex mutex;
  recorder::ChainVerdict chain;
  recorder::Recording recording;
};

py::dict headerOf(const OpenedRecording& opened) {
  py::dict out;
  recorder::forEachAttribute(opened.recording.header(),
                             [&](const char* name, const auto& value) { out[name] = value; });
  return out;
}

py::object signatureOf(const OpenedRecording& opened) {
  const recorder::Recording& recording = opened.recording;
  const auto& signature = recording.signature();
  if (!signature) return py::none();
  const auto value =
      signature->value ? std::optional(bytesOf(signature->value->data(), signature->value->size())) : std::nullopt;
  return py::dict("public_key"_a = bytesOf(signature->publicKey.data(), signature->publicKey.size()), "value"_a = value,
                  "valid"_a = signature->fits(recording.status().back().chain));
}

py::list listOf(const std::vector<recorder::RecordedColumn>& columns) {
  py::list out;
  for (const recorder::RecordedColumn& c : columns)
    out.append(py::make_tuple(c.path, c.type, c.unit, c.width, c.vector, c.parts, bytesOf(c.values)));
  return out;
}

py::tuple columnsOf(OpenedRecording& opened) {
  const recorder::RecordedColumns columns =
      alone(opened.mutex, [&] { return recorder::recordedColumns(opened.recording); });
  return py::make_tuple(listOf(columns.ticks), listOf(columns.steps), bytesOf(columns.events));
}

py::tuple rawSamplesOf(OpenedRecording& opened) {
  const auto of = [&](Hand hand) {
    return bytesOf(alone(opened.mutex, [&] { return recorder::packedRawSamples(opened.recording, hand); }));
  };
  return py::make_tuple(of(Hand::left), of(Hand::right));
}

/// @throws Error (invalid) where there is none of that number
py::tuple keyframeOf(OpenedRecording& opened, std::size_t index) {
  const recorder::Keyframe keyframe = alone(opened.mutex, [&] {
    const std::size_t count = opened.recording.keyframeSteps().size();
    if (index >= count)
      throw Error(
          ErrorKind::invalid, Where{opened.recording.path().string()},
          "has " + std::to_string(count) + " keyframes, from 0 on: there is none of number " + std::to_string(index));
    return opened.recording.keyframe(index);
  });
  return py::make_tuple(keyframe.step, bytesOf(keyframe.state), bytesOf(keyframe.haptics));
}

}  // namespace

void bindRecording(py::module_& m) {
  py::class_<OpenedRecording>(m, "Recording", "A recording, checked in a process of its own, then opened.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("header", headerOf)
      .def_property_readonly("names", [](const OpenedRecording& o) { return o.recording.header().structures(); })
      .def_property_readonly("steps", [](const OpenedRecording& o) { return o.recording.stepCount(); })
      .def_property_readonly("ticks", [](const OpenedRecording& o) { return o.recording.tickCount(); })
      .def_property_readonly("seconds", [](const OpenedRecording& o) { return o.recording.seconds(); })
      .def_property_readonly("complete", [](const OpenedRecording& o) { return o.recording.complete(); })
      .def_property_readonly("outcome",
                             [](const OpenedRecording& o) { return recorder::wordFor(o.recording.outcome()); })
      .def_property_readonly("keyframe_steps", [](const OpenedRecording& o) { return o.recording.keyframeSteps(); })
      .def_property_readonly("chain_intact", [](const OpenedRecording& o) { return o.chain.intact(); })
      .def_property_readonly("chain_fault", [](const OpenedRecording& o) { return analytics::wordsFor(o.chain); })
      .def_property_readonly("chain_head",
                             [](const OpenedRecording& o) {
                               const auto& head = o.recording.status().back().chain;
                               return bytesOf(head.data(), head.size());
                             })
      .def_property_readonly("signature", signatureOf)
      .def("columns", columnsOf, "Columns of ticks, columns of steps, packed events.")
      .def("keyframe", keyframeOf, "index"_a, "Step, bytes of the State, bytes of the haptic states.")
      .def("raw_samples", rawSamplesOf, "Packed raw samples of the left and of the right hand's device.");
}

}  // namespace calot::python
