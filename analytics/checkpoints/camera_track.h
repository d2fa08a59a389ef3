// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/engine/observer.h"
#include "recorder/sources/scope/picture_geometry.h"

namespace calot::analytics {

/// The endoscope of an attempt, step by step: the pose of each step's last tick, which is what a picture of it shows.
class CameraTrack {
 public:
  explicit CameraTrack(const recorder::PictureFrame& frame) : frame_(frame), camera_(frame.start) {}

  void take(const recorder::StepRecord& record);

  [[nodiscard]] const recorder::PictureFrame& frame() const { return frame_; }
  [[nodiscard]] const CameraSample& camera() const { return camera_; }
  /// Did any step have another pose than the first one?
  [[nodiscard]] bool moved() const { return moved_; }
  /// Is the point inside the picture?
  [[nodiscard]] bool sees(const Vec3& p_W) const { return recorder::isInPicture(frame_, camera_, p_W); }

 private:
  recorder::PictureFrame frame_;
  CameraSample camera_, first_;
  bool any_ = false, moved_ = false;
};

}  // namespace calot::analytics
