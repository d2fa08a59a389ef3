// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_mapping.h"

#include <algorithm>

#include "recorder/sources/pointing.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {

DeviceMapping::DeviceMapping(const HandDescription& hand, const CameraSample& camera,
                             const HandCalibration* calibration, const HandCalibration* shared)
    : hand_(hand), axes_(camera.orientation) {
  for (const HandCalibration* c : {calibration, shared}) {
    if (c == nullptr || !c->axes || !c->scale) continue;
    axes_ = camera.orientation * *c->axes;
    scale_ = *c->scale;
    break;
  }
  if (calibration != nullptr && calibration->tipOffset) tipOffset_ = *calibration->tipOffset;
}

void DeviceMapping::anchor(const DeviceSample& sample, const Vec3& position, const Quat& orientation) {
  tip0_ = sample.position + sample.orientation * tipOffset_;
  turn0_ = sample.orientation;
  anchor_ = position;
  orientation_ = orientation;
  anchored_ = true;
}

void DeviceMapping::anchorAtHome(const DeviceSample& sample) {
  anchor(sample, hand_.home, pointing(hand_.port, hand_.home));
}

InstrumentSample DeviceMapping::map(const DeviceSample& sample) const {
  InstrumentSample out;
  out.instrument = hand_.instrument;
  const Vec3 tip = sample.position + sample.orientation * tipOffset_;
  out.position = anchor_ + scale_ * (axes_ * (tip - tip0_));
  const Quat turn = axes_ * (sample.orientation * turn0_.conjugate()) * axes_.conjugate();
  out.orientation = alignedToShaft(turn * orientation_, shaftDirection(hand_.port, out.position));
  out.jaw = std::min(notNegative(sample.gripper), widestJaw);
  out.buttons = static_cast<std::uint8_t>(sample.buttons & ~clutchButton);
  return out;
}

}  // namespace calot::recorder
