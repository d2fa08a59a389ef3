// SPDX-License-Identifier: GPL-3.0-or-later

#include "python/bindings.h"
#include "python/places.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/writer.h"
#include "recorder/sources/performer.h"
#include "recorder/words.h"

namespace py = pybind11;

namespace calot::python {

namespace {

/// What `calot record` does with a performer. @returns outcome, seconds
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
  recorder::Session session(model, seed, pool, &prepared->compliances());
  session.join(writer);
  recorder::RunSettings run;
  run.seconds = seconds;
  const recorder::RunReport report = recorder::runAttempt(session, *source, run);
  writer.finish();
  prepared->save();
  return {recorder::wordFor(report.outcome), static_cast<double>(report.steps) * model.stepSeconds()};
}

}  // namespace

void bindRecord(py::module_& m) {
  m.def("record", record, py::arg("path"), py::arg("scene"), py::arg("performer"), py::arg("seed"), py::arg("seconds"),
        py::arg("participant"), py::arg("purpose"), py::arg("mode"), py::arg("force"));
}

}  // namespace calot::python
