// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <memory>

#include "analytics/checkpoints/replay_words.h"
#include "python/bindings.h"
#include "python/step_facts.h"
#include "recorder/engine/state_fields.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/probe.h"
#include "sim/math/executor.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// Re-simulates a recording step by step, and compares each with what is recorded.
struct SteppedReplay {
  explicit SteppedReplay(const std::filesystem::path& file)
      : path(file),
        chainIntact(recorder::probe(file).intact()),
        recording(file),
        choice(recording, {}),
        scene(recorder::sceneOf(recording)),
        engine(choice.make(executor)),
        facts(choice.scene()) {
    engine->start(recording.header().seed);
  }

  /// Does up to `steps` steps. @returns whether the last of them is there @throws Error as throwUnlessExact()
  bool advance(std::uint64_t steps) {
    const auto fail = [&] { throwUnlessExact(recorder::replayRecording(path, {})); };  // says what a whole replay says
    const std::uint64_t end = std::min(engine->steps() + steps, recording.stepCount());
    if (engine->steps() < end) {
      if (recorder::follow(recording, *engine, end, {&facts})) fail();
      return true;
    }
    if (!over) choice.save();
    over = true;
    if (!chainIntact) fail();  // the re-simulation agrees, and the recording was changed all the same
    return false;
  }

  std::mutex mutex;
  std::filesystem::path path;
  bool chainIntact = false, over = false;
  recorder::Recording recording;
  recorder::EngineChoice choice;
  std::shared_ptr<recorder::PreparedScene> scene;
  SerialExecutor executor;
  std::unique_ptr<recorder::Engine> engine;
  FactsObserver facts;
};

py::object nextOf(SteppedReplay& replay, std::uint64_t steps) {
  const bool there = alone(replay.mutex, [&] { return replay.advance(steps); });
  return there ? py::cast(replay.facts.facts()) : py::object(py::none());
}

py::dict replayed(const std::filesystem::path& path, unsigned threads, bool anyway, bool apart) {
  return reportOf(withoutLock([&] {
    recorder::ReplaySettings settings;
    settings.threads = threads;
    settings.engine = {apart, anyway, {}};
    recorder::ReplayReport report = recorder::replayRecording(path, settings);
    if (!anyway || report.verdict != recorder::ReplayVerdict::undecided) throwUnlessExact(report);
    return report;
  }));
}

}  // namespace

py::list columnList(const std::vector<recorder::wire::Column>& columns) {
  py::list list;
  for (const recorder::wire::Column& c : columns) list.append(py::make_tuple(c.path, c.type, c.width));
  return list;
}

py::dict reportOf(const recorder::ReplayReport& r) {
  return py::dict("file"_a = r.path.string(), "verdict"_a = recorder::wordFor(r.verdict), "attempt"_a = r.attempt,
                  "complete"_a = r.complete, "steps"_a = r.steps, "seconds"_a = r.seconds,
                  "wall_seconds"_a = r.wallSeconds, "simulation_version"_a = r.simulationVersion,
                  "chain_intact"_a = r.chainIntact(), "missed_tolerance"_a = r.misses.any,
                  "message"_a = analytics::wordsFor(r));
}

void bindReplay(py::module_& m) {
  py::class_<StepFacts>(m, "Facts", "Result of a step, as bytes.")
      .def_readonly("step", &StepFacts::step)
      .def_readonly("phase", &StepFacts::phase)
      .def_readonly("critical_view", &StepFacts::criticalView)
      .def_readonly("errors", &StepFacts::errors)
      .def_readonly("critical_errors", &StepFacts::criticalErrors)
      .def_property_readonly("observation", [](const StepFacts& f) { return bytesOf(f.observation); })
      .def_property_readonly("row", [](const StepFacts& f) { return bytesOf(f.row); })
      .def_property_readonly("forces", [](const StepFacts& f) { return bytesOf(f.forces); })
      .def_property_readonly("events", [](const StepFacts& f) { return bytesOf(f.events); })
      .def_property_readonly("digest", [](const StepFacts& f) { return bytesOf(f.digest); });
  py::class_<SteppedReplay>(m, "Replay", "Re-simulates a recording step by step, and compares.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("advance", nextOf, "steps"_a = 1, "Does these steps; the facts of the last one, or None at the end.")
      .def_property_readonly(
          "columns", [](const SteppedReplay& r) { return columnList(recorder::resultColumns(r.scene->model())); })
      .def_property_readonly("steps", [](const SteppedReplay& r) { return r.engine->steps(); });
  m.def("result_units", resultUnits, "Unit of each field of a step's result.");
  m.def("replay", replayed, "path"_a, "threads"_a, "anyway"_a, "apart"_a);
}

}  // namespace calot::python
