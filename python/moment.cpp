// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/moment.h"

#include <fmt/format.h>

#include "recorder/base/errors.h"
#include "recorder/recording/probe.h"

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

}  // namespace

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

gui::Image draw(const Moment& moment, const DrawSettings& settings) {
  if (settings.quality != "film" && settings.quality != "interactive")
    throw Error(
        ErrorKind::invalid,
        fmt::format("'{}' is not a quality of pictures: 'film' or 'interactive' is expected", settings.quality));
  gui::RenderSettings how;
  how.quality = settings.quality == "film" ? gui::Quality::film : gui::Quality::interactive;
  how.endoscopeMask = settings.mask;
  how.cavity = settings.cavity;
  if (!settings.camera && !settings.fieldOfView)
    return renderer()->render(moment.view, settings.width, settings.height, how, moment.smoke);
  SceneView view = moment.view;
  if (settings.camera) {
    const std::array<double, 7>& c = *settings.camera;
    view.camera.position = Vec3(c[0], c[1], c[2]);
    view.camera.orientation = Quat(c[3], c[4], c[5], c[6]);
  }
  if (settings.fieldOfView) view.verticalFieldOfView = *settings.fieldOfView;
  return renderer()->render(view, settings.width, settings.height, how, moment.smoke);
}

void endRendering() {
  const std::lock_guard lock(rendererMutex);
  sharedRenderer().reset();
}

MomentSeeker::MomentSeeker(const std::filesystem::path& path)
    : recording_(probed(path)), choice_(recording_, {}), seeker_(recording_, choice_) {
  if (choice_.isInside()) scene_ = recorder::sceneOf(recording_);
}

std::vector<gui::Puff> MomentSeeker::smokeAfter(std::uint64_t step) {
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

Moment MomentSeeker::seek(std::uint64_t step) {
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

}  // namespace calot::python
