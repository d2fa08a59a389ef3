// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "gui/render/renderer.h"
#include "python/bindings.h"
#include "python/moment.h"
#include "recorder/engine/state_fields.h"
#include "recorder/recording/probe.h"

namespace py = pybind11;

namespace calot::python {

namespace {

std::mutex rendererMutex;

std::shared_ptr<gui::Renderer>& sharedRenderer() {
  static std::shared_ptr<gui::Renderer> renderer;
  return renderer;
}

/// Making one takes a thread and a context: all moments share it.
std::shared_ptr<gui::Renderer> renderer() {
  const std::lock_guard lock(rendererMutex);
  std::shared_ptr<gui::Renderer>& shared = sharedRenderer();
  if (!shared) shared = std::make_shared<gui::Renderer>();
  return shared;
}

/// @throws as recorder::probe()
const std::filesystem::path& probed(const std::filesystem::path& path) {
  recorder::probe(path);
  return path;
}

/// Ends the renderer's thread; a later picture begins another.
void endRendering() {
  const std::lock_guard lock(rendererMutex);
  sharedRenderer().reset();
}

/// Every field of the State. @throws Error (undecided) where this version does not know what its bytes mean
std::vector<recorder::StateField> fieldsOf(const Moment& moment) {
  if (!moment.scene)
    throw Error(ErrorKind::undecided, Where{moment.file},
                "its State is of another simulation version, whose engine alone knows what the bytes mean");
  State state;
  if (!restoreState(moment.scene->model(), moment.state, state))
    throw Error(ErrorKind::damaged, Where{moment.file},
                fmt::format("the State of step {} cannot be restored", moment.view.step));
  return recorder::stateFields(moment.scene->model(), state);
}

/// Moments of a recording. May be used by several threads, one at a time.
class MomentSeeker {
 public:
  explicit MomentSeeker(const std::filesystem::path& path)
      : recording_(probed(path)), choice_(recording_, {}), seeker_(recording_, choice_) {
    if (choice_.isInside()) scene_ = recorder::sceneOf(recording_);
  }

  /// The moment after a step. @throws Error (invalid) where there is no such step; as recorder::Seeker::seek()
  Moment seek(std::uint64_t step) {
    const std::lock_guard lock(mutex_);
    if (step >= recording_.stepCount())
      throw Error(ErrorKind::invalid, Where{recording_.path().string()},
                  fmt::format("has {} steps, from 0 on: there is no step {}", recording_.stepCount(), step));
    seeker_.seek(step);
    if (const auto& differs = seeker_.differsFrom())
      throw Error(ErrorKind::refused, Where{recording_.path().string()},
                  fmt::format("diverged at step {}: from there on another attempt would be shown", *differs));
    Moment moment;
    moment.view = seeker_.view();
    moment.smoke = smokeAfter(step);
    moment.file = recording_.path().string();
    moment.scene = scene_;
    if (scene_) moment.state = seeker_.keyframe().state;
    return moment;
  }

 private:
  std::vector<gui::Puff> smokeAfter(std::uint64_t step) {
    if (recording_.header().purpose == "golden") return {};  // holds no results
    const double stepSeconds = recording_.header().tickSeconds * recording_.header().ticksPerStep;
    if (smokeSteps_ > step + 1) {
      smoke_ = {};
      smokeSteps_ = 0;
    }
    for (; smokeSteps_ <= step; ++smokeSteps_)
      smoke_.add(static_cast<double>(smokeSteps_ + 1) * stepSeconds, recording_.step(smokeSteps_).result.events);
    return smoke_.at(static_cast<double>(step + 1) * stepSeconds);
  }

  std::mutex mutex_;
  recorder::Recording recording_;
  recorder::EngineChoice choice_;
  recorder::Seeker seeker_;
  std::shared_ptr<recorder::PreparedScene> scene_;
  gui::SmokeTrail smoke_;
  std::uint64_t smokeSteps_ = 0;
};

py::bytes vectorsOf(const std::vector<Vec3>& vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return bytesOf(vectors);
}

py::tuple poseOf(const Vec3& p, const Quat& q) {
  return py::make_tuple(p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

py::list surfacesOf(const Moment& moment) {
  py::list out;
  for (const SurfaceView& s : moment.view.surface)
    out.append(py::make_tuple(s.organ, vectorsOf(s.position), vectorsOf(s.rest),
                              bytesOf(s.triangle.data(), s.triangle.size() * sizeof(Index3))));
  return out;
}

py::list instrumentsOf(const Moment& moment) {
  py::list out;
  for (const InstrumentView& i : moment.view.instrument)
    out.append(
        py::make_tuple(static_cast<int>(i.kind), poseOf(i.pose.position, i.pose.orientation), i.jaw, i.touching));
  return out;
}

py::tuple cameraOf(const Moment& moment) {
  const CameraSample& c = moment.view.camera;
  return py::make_tuple(poseOf(c.position, c.orientation), moment.view.verticalFieldOfView);
}

py::list stateOf(const Moment& moment) {
  py::list out;
  for (const recorder::StateField& f : withoutLock([&] { return fieldsOf(moment); })) {
    if (const auto* reals = std::get_if<std::vector<double>>(&f.values)) {
      out.append(py::make_tuple(f.name, "f8", bytesOf(*reals)));
    } else {
      out.append(py::make_tuple(f.name, "u8", bytesOf(std::get<std::vector<std::uint64_t>>(f.values))));
    }
  }
  return out;
}

/// @param camera p_WC and q_WC (w x y z); none: the endoscope's @param fieldOfView vertical (rad); none: the
/// endoscope's
/// @throws Error as gui::Renderer::render(); invalid for another quality than "film" and "interactive"
py::tuple rendered(const Moment& moment, int width, int height, const std::string& quality, bool mask, bool cavity,
                   const std::optional<std::array<double, 7>>& camera, const std::optional<double>& fieldOfView) {
  if (quality != "film" && quality != "interactive")
    throw Error(ErrorKind::invalid,
                fmt::format("'{}' is not a quality of pictures: 'film' or 'interactive' is expected", quality));
  gui::RenderSettings how;
  how.quality = quality == "film" ? gui::Quality::film : gui::Quality::interactive;
  how.endoscopeMask = mask;
  how.cavity = cavity;
  const gui::Image image = withoutLock([&] {
    if (!camera && !fieldOfView) return renderer()->render(moment.view, width, height, how, moment.smoke);
    SceneView view = moment.view;
    if (camera) {
      const std::array<double, 7>& c = *camera;
      view.camera.position = Vec3(c[0], c[1], c[2]);
      view.camera.orientation = Quat(c[3], c[4], c[5], c[6]);
    }
    if (fieldOfView) view.verticalFieldOfView = *fieldOfView;
    return renderer()->render(view, width, height, how, moment.smoke);
  });
  return py::make_tuple(image.width, image.height, bytesOf(image.rgba));
}

}  // namespace

void bindMoment(py::module_& m) {
  py::class_<Moment>(m, "Moment", "A scene after a step.")
      .def_property_readonly("step", [](const Moment& o) { return o.view.step; })
      .def_property_readonly("time", [](const Moment& o) { return o.view.time; })
      .def_property_readonly("surfaces", surfacesOf)
      .def_property_readonly("instruments", instrumentsOf)
      .def_property_readonly("camera", cameraOf)
      .def("state", stateOf)
      .def("render", rendered, "width"_a, "height"_a, "quality"_a, "mask"_a, "cavity"_a, "camera"_a, "field_of_view"_a);
  py::class_<MomentSeeker>(m, "Seeker", "Goes anywhere in a recording.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("seek", &MomentSeeker::seek, "step"_a, py::call_guard<py::gil_scoped_release>());
  m.def("end_rendering", endRendering, "Ends the thread that draws, before the interpreter does.");
}

}  // namespace calot::python
