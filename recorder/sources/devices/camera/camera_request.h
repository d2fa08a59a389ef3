// SPDX-License-Identifier: GPL-3.0-or-later
// What behind "camera:" is asked for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/device_kind.h"

namespace calot::recorder {

struct CameraRequest {
  std::vector<std::string> cameras;  ///< one or two: /dev/videoN, or films
  bool live = false;
  bool paced = false;  ///< films come in real time, as cameras' pictures do
  std::string keys;    ///< input device of the pedals, or empty
};

/// "0", "/dev/video0", "FILM", "FILM,FILM", "paced,FILM", "0,2,keys=/dev/input/event3".
/// @throws Error (invalid)
CameraRequest parseCameraRequest(const DeviceRequest& request);

/// Identity of live cameras, from what their drivers call them.
std::string cameraIdentity(const std::vector<std::string>& cards);

/// @throws Error (damaged) naming the file
std::vector<std::unique_ptr<FrameSource>> openFilmSources(const std::vector<std::string>& files);

}  // namespace calot::recorder
