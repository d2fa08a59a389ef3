// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/camera_track.h"

#include "sim/scene/measurement.h"

namespace calot::analytics {

void CameraTrack::take(const recorder::StepRecord& record) {
  if (record.samples.empty()) return;
  const CameraSample& newest = record.samples.back().camera;
  if (!isMeasurement(newest)) return;  // the pose before is held, as in the simulation
  camera_ = newest;
  if (!any_) first_ = newest;
  any_ = true;
  moved_ = moved_ || newest.position != first_.position || newest.orientation.coeffs() != first_.orientation.coeffs();
}

}  // namespace calot::analytics
