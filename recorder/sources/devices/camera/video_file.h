// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "recorder/sources/devices/camera/frame_source.h"

namespace calot::recorder {

/// A film as a camera's pictures: anything that libav reads, decoded on one thread, so that it is the same every time.
/// Frames that are missing are found by the times that the file gives.
class VideoFile final : public FrameSource {
 public:
  /// @throws Error (damaged) naming the file, where there is no film in it, or its frames have no times
  explicit VideoFile(const std::filesystem::path& file);
  ~VideoFile() override;

  FrameStatus next(std::chrono::nanoseconds wait, Frame& out) override;
  [[nodiscard]] int width() const override;
  [[nodiscard]] int height() const override;
  [[nodiscard]] double rate() const override;
  [[nodiscard]] std::string name() const override;
  /// Empty where the film ended as a whole one does.
  [[nodiscard]] std::string reason() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace calot::recorder
