// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>

#include "recorder/sources/devices/camera/lens_calibration.h"
#include "recorder/sources/devices/camera/marker_sheets.h"

namespace calot::recorder {
namespace {

constexpr std::size_t fewestTags = 10;
constexpr std::size_t mostViews = 30;
constexpr double stillPixels = 4.0;      // from frame to frame
constexpr double differentShare = 0.04;  // of the image's width, from view to view

std::vector<SeenTag> boardTagsOf(std::vector<SeenTag> tags) {
  std::erase_if(
      tags, [](const SeenTag& t) { return t.id < firstBoardTag || t.id >= firstBoardTag + boardColumns * boardRows; });
  return tags;
}

/// Mean distance of the corners that both show; nothing where they share fewer than four tags.
std::optional<double> meanMotion(const std::vector<SeenTag>& a, const std::vector<SeenTag>& b) {
  double sum = 0.0;
  int count = 0;
  for (const SeenTag& x : a) {
    for (const SeenTag& y : b) {
      if (x.id != y.id) continue;
      for (std::size_t k = 0; k < 4; ++k) sum += (x.corner[k] - y.corner[k]).norm();
      ++count;
    }
  }
  if (count < 4) return std::nullopt;
  return sum / (4.0 * count);
}

/// Keeps views that are unlike those that are there; thins them out when there are too many.
class ViewPicker {
 public:
  explicit ViewPicker(int width) : different_(differentShare * width) {}

  /// @returns whether a picture that follows the last one is worth keeping
  bool offer(const std::vector<SeenTag>& tags) {
    const std::vector<SeenTag> before = std::exchange(last_, tags);
    if (tags.size() < fewestTags || kept_.size() >= mostViews) return false;
    const std::optional<double> motion = meanMotion(before, tags);
    if (!motion || *motion > stillPixels) return false;
    const bool unlike = std::all_of(kept_.begin(), kept_.end(), [&](const auto& other) {
      const std::optional<double> apart = meanMotion(other, tags);
      return !apart || *apart > different_;
    });
    if (unlike) kept_.push_back(tags);
    return unlike;
  }

 private:
  double different_;
  std::vector<SeenTag> last_;
  std::vector<std::vector<SeenTag>> kept_;
};

}  // namespace

std::vector<BoardView> boardViews(FrameSource& source) {
  TagDetector detector;
  ViewPicker picker(source.width());
  std::vector<BoardView> out;
  Frame frame;
  while (source.next(std::chrono::nanoseconds(0), frame) == FrameStatus::frame) {
    std::vector<SeenTag> tags = boardTagsOf(detector.detect(frame.image));
    if (picker.offer(tags)) out.push_back({frame.time, std::move(tags)});
  }
  return out;
}

void pairedViews(FrameSource& first, FrameSource& second, std::vector<BoardView>& ofFirst,
                 std::vector<BoardView>& ofSecond) {
  TagDetector detector;
  ViewPicker picker(first.width());
  const auto near = static_cast<std::int64_t>(0.5e9 / std::max(first.rate(), second.rate()));
  Frame a, b;
  bool more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame &&
              second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
  while (more) {
    if (std::abs(a.time - b.time) <= near) {
      std::vector<SeenTag> mine = boardTagsOf(detector.detect(a.image));
      if (picker.offer(mine)) {
        std::vector<SeenTag> theirs = boardTagsOf(detector.detect(b.image));
        if (theirs.size() >= fewestTags) {
          ofFirst.push_back({a.time, std::move(mine)});
          ofSecond.push_back({b.time, std::move(theirs)});
        }
      }
      more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame &&
             second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
    } else if (a.time < b.time) {
      more = first.next(std::chrono::nanoseconds(0), a) == FrameStatus::frame;
    } else {
      more = second.next(std::chrono::nanoseconds(0), b) == FrameStatus::frame;
    }
  }
}

}  // namespace calot::recorder
