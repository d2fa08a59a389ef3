// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/window_input.h"
#include "recorder/sources/scope/endoscope.h"

namespace calot::recorder {

/// The endoscope by a device of its own, beside those of the hands. Its right hand's pose, relative to where it was
/// when it was first measured, swings the shaft (right and up), moves it in (away), and rotates the light cable, or the
/// camera head of a straight optic (about the shaft). The cut pedal rotates the camera head counter-clockwise, the
/// coagulation pedal clockwise.
///
/// While the device is gone or measures nothing the endoscope stands still; it goes on from there. Its raw samples are
/// not recorded: the endoscope's pose is.
class ScopeDevice final : public ScopeDriver {
 public:
  static constexpr double swingOfMetre = 7.0;  ///< rad/m: 150 mm are the whole swing to one side
  static constexpr double headSpeed = 0.5;     ///< rad/s

  /// @param device opened for the right hand @param straight the optic is
  ScopeDevice(OpenedDevice device, bool straight);

  void setOut(const ScopeJoints& joints) override;
  [[nodiscard]] ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) override;
  void rest() override;
  [[nodiscard]] bool realTime() const override { return !device_.tickClock; }

 private:
  void gather();

  OpenedDevice device_;
  bool straight_;
  DevicePump pump_;  ///< after the device: it ends first
  DeviceInput input_;
  std::optional<DeviceSample> newest_, anchor_;  ///< valid
  ScopeJoints from_, aim_;
  double rolled_ = 0.0;  ///< about the shaft since the anchor (rad)
};

/// The endoscope by the keys and the mouse of a window: it moves while a key is held, and stays where it is let go.
class ScopeKeys final : public ScopeDriver {
 public:
  static constexpr double swingSpeed = 0.3;     ///< rad/s
  static constexpr double insertSpeed = 0.03;   ///< m/s
  static constexpr double rotateSpeed = 0.8;    ///< rad/s
  static constexpr double pixelSwing = 0.0015;  ///< rad
  static constexpr double notchInsert = 0.005;  ///< m

  /// @param input not null
  explicit ScopeKeys(std::shared_ptr<ScopeInput> input) : input_(std::move(input)) {}

  void setOut(const ScopeJoints& joints) override;
  [[nodiscard]] ScopeJoints wish(double time, const ScopeJoints& present, const TickSamples& hands) override;
  void rest() override { static_cast<void>(input_->take()); }

 private:
  std::shared_ptr<ScopeInput> input_;
  ScopeJoints aim_;
};

}  // namespace calot::recorder
