// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>

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
class SteppedReplay {
 public:
  explicit SteppedReplay(const std::filesystem::path& path)
      : path_(path),
        chainIntact_(recorder::probe(path).intact),
        recording_(path),
        choice_(recording_, {}),
        scene_(recorder::sceneOf(recording_)),
        engine_(choice_.make(executor_)),
        facts_(choice_.scene()),
        observers_{&facts_} {
    engine_->start(recording_.header().seed);
  }

  /// Does up to `steps` steps. @returns whether the last of them is there @throws ReplayFault
  bool advance(std::uint64_t steps) {
    const std::lock_guard lock(mutex_);
    const std::uint64_t end = std::min(engine_->steps() + steps, recording_.stepCount());
    if (engine_->steps() < end) {
      if (recorder::follow(recording_, *engine_, end, observers_)) fail();
      return true;
    }
    if (!over_) choice_.save();
    over_ = true;
    if (!chainIntact_) fail();  // the re-simulation agrees, and the recording was changed all the same
    return false;
  }

  [[nodiscard]] const StepFacts& facts() const { return facts_.facts(); }
  [[nodiscard]] std::vector<recorder::wire::Column> columns() const { return recorder::resultColumns(scene_->model()); }
  [[nodiscard]] std::uint64_t steps() const { return engine_->steps(); }

 private:
  /// Throws what a whole replay says of the recording.
  void fail() const { throwUnlessExact(recorder::replayRecording(path_, {})); }

  std::mutex mutex_;
  std::filesystem::path path_;
  bool chainIntact_ = false, over_ = false;
  recorder::Recording recording_;
  recorder::EngineChoice choice_;
  std::shared_ptr<recorder::PreparedScene> scene_;
  SerialExecutor executor_;
  std::unique_ptr<recorder::Engine> engine_;
  FactsObserver facts_;
  std::vector<recorder::Observer*> observers_;
};

py::object nextOf(SteppedReplay& replay, std::uint64_t steps) {
  const bool there = withoutLock([&] { return replay.advance(steps); });
  return there ? py::cast(replay.facts()) : py::object(py::none());
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
                  "chain_intact"_a = r.chainIntact, "missed_tolerance"_a = r.misses.any,
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
      .def_property_readonly("columns", [](const SteppedReplay& r) { return columnList(r.columns()); })
      .def_property_readonly("steps", &SteppedReplay::steps);
  m.def("result_units", resultUnits, "Unit of each field of a step's result.");
  m.def("replay", replayed, "path"_a, "threads"_a, "anyway"_a, "apart"_a);
}

}  // namespace calot::python
