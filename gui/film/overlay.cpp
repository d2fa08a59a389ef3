// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "gui/film/lettering.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr Colour white{245, 245, 245}, amber{255, 190, 70}, grey{190, 190, 190};
constexpr std::array<Colour, handCount> handColour{Colour{90, 200, 255}, Colour{255, 170, 60}};  // blue and orange

constexpr std::array<std::pair<std::string_view, bool Overlays::*>, 5> overlayWords{{
    {"time", &Overlays::time},
    {"phase", &Overlays::phase},
    {"checkpoints", &Overlays::checkpoints},
    {"events", &Overlays::events},
    {"tools", &Overlays::tools},
}};

/// A dot with a soft edge.
void dot(Image& image, double x, double y, double radius, const Colour& colour, double opacity) {
  for (int py = static_cast<int>(std::floor(y - radius)); py <= static_cast<int>(std::ceil(y + radius)); ++py)
    for (int px = static_cast<int>(std::floor(x - radius)); px <= static_cast<int>(std::ceil(x + radius)); ++px)
      blend(image, px, py, colour,
            opacity * std::clamp(radius + 0.5 - std::hypot(px + 0.5 - x, py + 0.5 - y), 0.0, 1.0));
}

void drawPaths(Image& image, const Moment& moment, const SceneView& view) {
  const Mat3 toCamera = view.camera.orientation.normalized().conjugate().toRotationMatrix();
  const double focal = 0.5 * image.height / std::tan(0.5 * view.verticalFieldOfView);
  const double radius = std::max(1.0, image.height / 480.0);
  for (std::size_t h = 0; h < handCount; ++h) {
    bool drawn = false;
    double lastX = 0.0, lastY = 0.0;
    for (const Moment::Place& place : moment.path[h]) {
      const Vec3 p = toCamera * (place.p_W - view.camera.position);
      if (p.z() < 1e-3) {
        drawn = false;
        continue;
      }
      const double x = 0.5 * image.width + focal * p.x() / p.z(), y = 0.5 * image.height + focal * p.y() / p.z();
      const double away = drawn ? std::hypot(x - lastX, y - lastY) : 1e9;
      if (away < 1.0) continue;                                                         // at rest, dots would pile up
      const int steps = away < 200.0 ? static_cast<int>(std::ceil(away / radius)) : 1;  // else it jumped: one dot
      const double opacity = 0.55 * (1.0 - (moment.time - place.time) / Moment::pathSeconds);
      for (int i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps;
        const double fromX = steps > 1 ? lastX : x, fromY = steps > 1 ? lastY : y;
        dot(image, fromX + share * (x - fromX), fromY + share * (y - fromY), radius, handColour[h], opacity);
      }
      drawn = true;
      lastX = x;
      lastY = y;
    }
  }
}

}  // namespace

Overlays parseOverlays(const std::string& text) {
  Overlays overlays;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = std::string_view(text).substr(begin, end - begin);
    const auto* const known = std::find_if(overlayWords.begin(), overlayWords.end(),
                                           [&](const auto& overlay) { return overlay.first == word; });
    if (known == overlayWords.end())
      throw Error(ErrorKind::invalid,
                  fmt::format("there is no overlay '{}'; there are time, phase, checkpoints, events, tools", word));
    overlays.*known->second = true;
    begin = end + 1;
  }
  return overlays;
}

OverlayPainter::OverlayPainter(int pictureHeight) : letters_(pictureHeight / 36), margin_(pictureHeight / 45) {}

void OverlayPainter::paintTitle(Image& image, std::string title) const {
  const int besideIt = 2 * (letters_.widthOf("00:00.0") + 2 * margin_);  // the time, and as much on the right
  if (letters_.widthOf(title) > image.width - besideIt) {
    while (!title.empty() && letters_.widthOf(title + "…") > image.width - besideIt) {
      while (title.size() > 1 && (static_cast<unsigned char>(title.back()) & 0xC0U) == 0x80U) title.pop_back();
      title.pop_back();
    }
    title += "…";
  }
  letters_.write(image, title, image.width / 2, margin_, Anchor::middle, white);
}

/// In lines that fit, broken at spaces: whatever the size of the picture, none of it is left out.
void OverlayPainter::paintDoubt(Image& image, const std::string& doubt) const {
  int y = image.height / 4;
  std::string line;
  const auto write = [&] {
    letters_.write(image, line, image.width / 2, y, Anchor::middle, amber);
    y += letters_.lineHeight();
  };
  for (std::size_t at = 0; at < doubt.size();) {
    const std::size_t end = std::min(doubt.find(' ', at), doubt.size());
    const std::string longer = line + (line.empty() ? "" : " ") + doubt.substr(at, end - at);
    if (!line.empty() && letters_.widthOf(longer) > image.width - 2 * margin_) {
      write();
      line = doubt.substr(at, end - at);
    } else {
      line = longer;
    }
    at = end + 1;
  }
  write();
}

void OverlayPainter::paintEvents(Image& image, const Moment& moment, int bottom) const {
  int y = bottom;
  for (auto line = moment.events.rbegin(); line != moment.events.rend(); ++line) {
    y -= letters_.lineHeight();
    if (y < image.height / 2) break;
    const double fading = std::clamp(Moment::eventSeconds - (moment.time - line->time), 0.0, 1.0);
    letters_.write(image, line->text, margin_, y, Anchor::left, line->fault ? amber : white, fading);
  }
}

void OverlayPainter::paint(Image& image, const Overlays& overlays, const Moment& moment, const SceneView& view,
                           const Captions& captions) const {
  const int bottom = image.height - margin_;
  if (overlays.tools) drawPaths(image, moment, view);
  int y = margin_;
  if (overlays.time) {
    letters_.write(image, timeText(moment.time), margin_, y, Anchor::left, white);
    y += letters_.lineHeight();
  }
  if (overlays.phase && !moment.phase.empty()) letters_.write(image, moment.phase, margin_, y, Anchor::left, white);
  if (overlays.checkpoints) {
    y = margin_ + (captions.title.empty() ? 0 : letters_.lineHeight());
    for (const std::string& line : moment.checkpoints) {
      letters_.write(image, line, image.width - margin_, y, Anchor::right, grey);
      y += letters_.lineHeight();
    }
  }
  const bool narrow = 3 * letters_.widthOf(captions.mark) > image.width;
  if (overlays.events) paintEvents(image, moment, bottom - (narrow ? letters_.lineHeight() : 0));
  if (!captions.mark.empty())
    letters_.write(image, captions.mark, image.width - margin_, bottom - letters_.lineHeight(), Anchor::right, grey,
                   0.85);
  if (!captions.title.empty()) paintTitle(image, captions.title);
  if (!captions.doubt.empty()) paintDoubt(image, captions.doubt);
}

}  // namespace calot::gui
