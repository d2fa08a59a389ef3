// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/edge_smoother.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

namespace calot::gui {
namespace {

constexpr int leastContrast = 10;        // levels; weaker edges show no steps
constexpr std::ptrdiff_t searched = 12;  // pixels along an edge in which its ends are looked for
constexpr std::ptrdiff_t margin = 1;     // pixels at the picture's border that stay as they are
constexpr std::size_t atOnce = 8;        // flags that are skipped together

}  // namespace

void EdgeSmoother::readBrightness(const Image& image) {
  const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  brightness_.resize(pixels);
  const std::uint8_t* from = image.rgba.data();
  for (std::size_t i = 0; i < pixels; ++i, from += 4)
    brightness_[i] = static_cast<std::uint8_t>((from[0] + 2 * from[1] + from[2]) >> 2);
}

// After Lottes, "FXAA" (NVIDIA, 2009; version 3.11): the ends of the edge say how much of the pixel lies beyond it.
void EdgeSmoother::smoothPixel(const Image& image, std::size_t at, std::ptrdiff_t x, std::ptrdiff_t y) {
  const std::ptrdiff_t row = image.width;
  const auto l = [&](std::ptrdiff_t i, std::ptrdiff_t j) { return brightness(at, j * row + i); };
  const int here = l(0, 0);
  const int bendDown = 2 * std::abs(l(0, -1) + l(0, 1) - 2 * here) + std::abs(l(1, -1) + l(1, 1) - 2 * l(1, 0)) +
                       std::abs(l(-1, -1) + l(-1, 1) - 2 * l(-1, 0));
  const int bendAside = 2 * std::abs(l(1, 0) + l(-1, 0) - 2 * here) + std::abs(l(1, -1) + l(-1, -1) - 2 * l(0, -1)) +
                        std::abs(l(1, 1) + l(-1, 1) - 2 * l(0, 1));
  const bool level = bendDown >= bendAside;
  const std::ptrdiff_t along = level ? 1 : row, up = level ? -row : -1;
  const int stepUp = std::abs(brightness(at, up) - here), stepDown = std::abs(brightness(at, -up) - here);
  const std::ptrdiff_t across = stepUp >= stepDown ? up : -up;
  const int sum = here + brightness(at, across), tolerated = std::max(stepUp, stepDown) / 2;

  const std::ptrdiff_t before = (level ? x : y) - margin;
  const std::ptrdiff_t behind = (level ? row - 1 - x : image.height - 1 - y) - margin;
  // @return pixels to the end of the edge, and the change of brightness there; 0: not within searched
  const auto end = [&](std::ptrdiff_t step, std::ptrdiff_t most) {
    int change = 0;
    std::ptrdiff_t n = 0;
    while (n < most) {
      ++n;
      change = brightness(at, n * step) + brightness(at, n * step + across) - sum;
      if (std::abs(change) > tolerated) return std::pair(n, change);
    }
    return std::pair(n + 1, 0);
  };
  const auto [first, changeFirst] = end(-along, std::min(searched, before));
  const auto [last, changeLast] = end(along, std::min(searched, behind));
  const int change = first < last ? changeFirst : changeLast;
  // Only the side of the step towards which the edge turns is cut.
  if (change == 0 || (change < 0) == (2 * here < sum)) return;
  const auto share = static_cast<int>(128 - 256 * std::min(first, last) / (first + last));  // of the neighbour, of 256
  if (share <= 0) return;
  const std::uint8_t* const a = image.rgba.data() + 4 * at;
  const std::uint8_t* const b = a + 4 * across;
  if (a[3] != b[3]) return;  // where nothing was drawn, there is no colour
  std::array<std::uint8_t, 4> mixed{};
  for (std::size_t c = 0; c < mixed.size(); ++c)
    mixed[c] = static_cast<std::uint8_t>((a[c] * (256 - share) + b[c] * share + 128) >> 8);
  std::uint32_t colour = 0;
  std::memcpy(&colour, mixed.data(), sizeof colour);
  changed_.emplace_back(at, colour);
}

void EdgeSmoother::smooth(Image& image) {
  readBrightness(image);
  const auto width = static_cast<std::size_t>(image.width);
  isEdge_.assign((width + atOnce) / atOnce * atOnce, 0);
  changed_.clear();
  for (std::ptrdiff_t y = margin; y < image.height - margin; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * width;
    const std::uint8_t* const row = brightness_.data() + begin;
    const std::uint8_t *const above = row - width, *const below = row + width;
    std::uint8_t* const flag = isEdge_.data();
    for (std::size_t x = margin; x + margin < width; ++x) {
      const std::uint8_t high = std::max({row[x], row[x - 1], row[x + 1], above[x], below[x]});
      const std::uint8_t low = std::min({row[x], row[x - 1], row[x + 1], above[x], below[x]});
      const auto wanted = std::max<std::uint8_t>(leastContrast, static_cast<std::uint8_t>(high >> 3U));
      flag[x] = static_cast<std::uint8_t>(high - low) > wanted ? 1 : 0;
    }
    for (std::size_t x = 0; x < width; x += atOnce) {
      std::uint64_t any = 0;
      std::memcpy(&any, flag + x, sizeof any);
      if (any == 0) continue;
      for (std::size_t k = x; k < x + atOnce; ++k)
        if (flag[k] != 0) smoothPixel(image, begin + k, static_cast<std::ptrdiff_t>(k), y);
    }
  }
  for (const auto& [at, colour] : changed_) std::memcpy(image.rgba.data() + 4 * at, &colour, sizeof colour);
}

}  // namespace calot::gui
