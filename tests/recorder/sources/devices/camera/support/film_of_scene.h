// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <fstream>

#include "recorder/sources/devices/camera/frame_source.h"

namespace calot::recorder::cameratest {

/// Grey pictures as an uncompressed film (YUV4MPEG2), which libav reads.
class PlainFilm {
 public:
  PlainFilm(const std::filesystem::path& file, int width, int height, int fps) : out_(file, std::ios::binary) {
    out_ << "YUV4MPEG2 W" << width << " H" << height << " F" << fps << ":1 Ip A1:1 Cmono\n";
  }
  void add(const GreyImage& image) {
    out_ << "FRAME\n";
    out_.write(reinterpret_cast<const char*>(image.pixels.data()), static_cast<std::streamsize>(image.pixels.size()));
  }

 private:
  std::ofstream out_;
};

}  // namespace calot::recorder::cameratest
