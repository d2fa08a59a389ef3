// SPDX-License-Identifier: GPL-3.0-or-later
// Where a camera's pictures come from.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "recorder/sources/devices/camera/tag_detector.h"

namespace calot::recorder {

struct Frame {
  GreyImage image;
  std::int64_t time = 0;     ///< exposure of the middle row (ns): of a file from its begin, else the host's clock
  std::uint64_t missed = 0;  ///< frames that should have come between the one before and this one
};

enum class FrameStatus : std::uint8_t {
  frame,
  none,   ///< not yet
  lost,   ///< the camera is gone; it may come back
  ended,  ///< a file: there is no more
};

/// One camera. Nothing here throws; a source is opened by its constructor.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;

  /// @param wait blocks at most so long; files never wait
  virtual FrameStatus next(std::chrono::nanoseconds wait, Frame& out) = 0;

  [[nodiscard]] virtual int width() const = 0;
  [[nodiscard]] virtual int height() const = 0;
  [[nodiscard]] virtual double rate() const = 0;  ///< nominal (1/s)
  [[nodiscard]] virtual std::string name() const = 0;
  /// Why it was lost, or how the file ended; one line.
  [[nodiscard]] virtual std::string reason() const { return {}; }
};

}  // namespace calot::recorder
