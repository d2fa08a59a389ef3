// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/moments/moments.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "gui/render/renderer.h"
#include "recorder/base/errors.h"

namespace calot::gui {

std::uint64_t stepAt(const recorder::Recording& recording, double time) {
  const auto steps = static_cast<double>(recording.stepCount());
  const double n = std::clamp(std::floor(time / (recording.seconds() / steps) + 1e-6), 0.0, steps - 1.0);
  return static_cast<std::uint64_t>(n);
}

void seekAsRecorded(recorder::Seeker& seeker, const recorder::Recording& recording, std::uint64_t step) {
  seeker.seek(step);
  if (const auto& differs = seeker.differsFrom())
    throw Error(ErrorKind::refused, Where{recording.path().filename().string()},
                fmt::format("diverged at step {}: from there on another operation would be shown", *differs));
}

std::vector<analytics::Picture> sheetPictures(
    const std::filesystem::path& file, const std::vector<analytics::SheetMoment>& moments,
    const std::function<void(std::uint64_t done, std::uint64_t of)>& progress) {
  std::vector<analytics::Picture> pictures;
  recorder::Recording recording(file);
  if (moments.empty() || recording.stepCount() == 0) return pictures;
  constexpr int width = 640, height = 480;
  recorder::Seeker seeker(recording);
  Renderer renderer;
  for (const analytics::SheetMoment& moment : moments) {
    seekAsRecorded(seeker, recording, stepAt(recording, moment.time));
    pictures.push_back({pngBytes(renderer.render(seeker.view(), width, height, Quality::film)), moment.caption});
    if (progress) progress(pictures.size(), moments.size());
  }
  return pictures;
}

}  // namespace calot::gui
