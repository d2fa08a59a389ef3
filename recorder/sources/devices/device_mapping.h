// SPDX-License-Identifier: GPL-3.0-or-later
// The place of a device's samples in the scene. It computes what a recording holds, so it keeps the determinism
// contract.
#pragma once

#include "recorder/recording/device_sample.h"
#include "recorder/sources/devices/calibration.h"
#include "sim/math/linear.h"
#include "sim/scene/description.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Mapping of device frame D into the scene for one hand:
///
///   p_WT = anchor_W + scale R_WC R_CD (tip_D - tip_D(0)),   tip_D = p_DI + q_DI tipOffset
///   q_WI = R (q_DI q_DI(0)^-1) R^-1 q_WI(0),                R = R_WC R_CD
///
/// where (0) is the sample at which the hand was anchored, C the scene's camera (x right, y down, z away) and R_CD,
/// scale and tipOffset the calibration's (none: D is read as C, 1, 0). The instrument goes through its port: of its
/// orientation the roll is left (alignedToShaft). Only + - * / and square roots.
class DeviceMapping {
 public:
  /// @param calibration the hand's, or none. @param shared where that has no axes or scale: another hand's of the same
  /// device, whose frame it shares.
  DeviceMapping(const HandDescription& hand, const CameraSample& camera, const HandCalibration* calibration,
                const HandCalibration* shared);

  [[nodiscard]] bool anchored() const { return anchored_; }

  /// Anchors the hand: from now on `sample` corresponds to this pose.
  void anchor(const DeviceSample& sample, const Vec3& position, const Quat& orientation);
  /// Anchors at the scene's home position, roll 0.
  void anchorAtHome(const DeviceSample& sample);

  /// Position, orientation, jaw (the gripper clamped to [0, 1.2] rad) and buttons, in W. Not rounded.
  /// @pre anchored()
  [[nodiscard]] InstrumentSample map(const DeviceSample& sample) const;

  /// A vector of W in D.
  [[nodiscard]] Vec3 inDevice(const Vec3& v) const { return axes_.conjugate() * v; }

 private:
  HandDescription hand_;
  Quat axes_ = Quat::Identity();  ///< q_WD
  double scale_ = 1.0;
  Vec3 tipOffset_ = Vec3::Zero();
  Vec3 tip0_ = Vec3::Zero();  ///< in D
  Quat turn0_ = Quat::Identity();
  Vec3 anchor_ = Vec3::Zero();
  Quat orientation_ = Quat::Identity();
  bool anchored_ = false;
};

}  // namespace calot::recorder
