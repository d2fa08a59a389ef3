// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/calibration_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "gui/film/lettering.h"
#include "gui/render/png_file.h"

namespace calot::apps {
namespace {

constexpr double arrowScale = 50.0;
constexpr int cellColumns = 8, cellRows = 6;  // as coverage counts them
constexpr gui::Colour seenCell{205, 228, 208}, unseenCell{244, 218, 214}, arrowColour{30, 60, 160},
    wordColour{255, 255, 255};

void paintPoint(gui::Image& image, int x, int y, const gui::Colour& colour) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  std::uint8_t* const pixel =
      image.rgba.data() +
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  std::copy(colour.begin(), colour.end(), pixel);
  pixel[3] = 255;
}

void paintStroke(gui::Image& image, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = 1 + static_cast<int>((to - from).cwiseAbs().maxCoeff());
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d at = from + (to - from) * (static_cast<double>(i) / steps);
    paintPoint(image, static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())), arrowColour);
  }
}

gui::Image pictureOf(const recorder::LensFit& fit, std::size_t number) {
  const recorder::CameraLens& lens = fit.lens;
  gui::Image image{
      lens.width, lens.height,
      std::vector<std::uint8_t>(4 * static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height))};
  std::set<int> seen;
  const auto cellOf = [&](double x, double y) {
    return static_cast<int>(y * cellRows / lens.height) * cellColumns + static_cast<int>(x * cellColumns / lens.width);
  };
  for (const recorder::CornerResidual& c : fit.residuals) seen.insert(cellOf(c.pixel.x(), c.pixel.y()));
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) paintPoint(image, x, y, seen.contains(cellOf(x, y)) ? seenCell : unseenCell);
  }
  for (const recorder::CornerResidual& c : fit.residuals) {
    paintStroke(image, c.pixel, c.pixel + arrowScale * c.error);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx)
        paintPoint(image, static_cast<int>(c.pixel.x()) + dx, static_cast<int>(c.pixel.y()) + dy, arrowColour);
    }
  }
  const gui::Lettering words(std::max(14, lens.height / 32));
  words.write(image,
              fmt::format("camera {}: {} views, {:.0f} % of the picture, residual {:.2f} pixels (arrows x {:.0f})",
                          number, lens.views, 100.0 * lens.coverage, lens.residual, arrowScale),
              10, 6, gui::Anchor::left, wordColour);
  return image;
}

}  // namespace

void writeCalibrationPictures(const recorder::RigFit& fit, const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < fit.lens.size(); ++i)
    gui::writePng(pictureOf(fit.lens[i], i + 1), folder / fmt::format("camera-{}.png", i + 1));
}

}  // namespace calot::apps
