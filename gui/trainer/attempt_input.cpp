// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/attempt_input.h"

#include <array>
#include <utility>

#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/scope/scope_source.h"

namespace calot::gui {
namespace {

constexpr double patience = 5.0;  // s

/// Ports and the endoscope's eye in D (the scene's camera's axes), seen from where the tips begin.
void setPlaces(recorder::MouseInput& mouse, const SceneDescription& scene, const CameraSample& camera,
               const std::array<Vec3, handCount>& tips) {
  std::array<Vec3, handCount> ports, eyes;
  for (std::size_t h = 0; h < handCount; ++h) {
    ports[h] = scene.camera.orientation.conjugate() * Vec3(scene.hands[h].port - tips[h]);
    eyes[h] = scene.camera.orientation.conjugate() * Vec3(camera.position - tips[h]);
  }
  mouse.setPorts(ports);
  mouse.setEyes(eyes);
}

}  // namespace

void AttemptInput::setOut(recorder::SampleSource& source, const SceneDescription& /*scene*/, const TickSamples& start) {
  if (auto* const device = source.device(); device != nullptr) device->setOutFrom(start);
  if (auto* const scope = source.scope(); scope != nullptr) scope->setOutFrom(start.camera);
}

MouseAttemptInput::MouseAttemptInput(std::shared_ptr<recorder::MouseInput> mouse,
                                     recorder::DeviceSourceSettings settings, AddScope addScope)
    : mouse_(std::move(mouse)), settings_(std::move(settings)), addScope_(std::move(addScope)) {}

std::unique_ptr<recorder::SampleSource> MouseAttemptInput::open(const SceneDescription& scene) {
  mouse_->reset();
  setPlaces(*mouse_, scene, scene.camera, {scene.hands[0].home, scene.hands[1].home});
  auto source =
      std::make_unique<recorder::DeviceSource>(std::make_unique<recorder::MouseDevice>(mouse_), scene, settings_);
  source->waitForFirst(patience);
  if (addScope_) return addScope_(std::move(source), scene);
  return source;
}

void MouseAttemptInput::setOut(recorder::SampleSource& source, const SceneDescription& scene,
                               const TickSamples& start) {
  setPlaces(*mouse_, scene, start.camera, {start.hand[0].position, start.hand[1].position});
  AttemptInput::setOut(source, scene, start);
}

}  // namespace calot::gui
