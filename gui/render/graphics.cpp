// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/graphics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

#include "recorder/base/errors.h"

namespace calot::gui {

const std::vector<std::string>& graphicsWords() {
  static const std::vector<std::string> words{"auto", "card", "software", "egl-software"};
  return words;
}

Graphics graphicsFrom(std::string_view word) {
  const std::vector<std::string>& words = graphicsWords();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw Error(ErrorKind::invalid, fmt::format("graphics '{}'; there are {}", word, fmt::join(words, ", ")));
  return static_cast<Graphics>(found - words.begin());
}

std::unique_ptr<GraphicsContext> createContext(Graphics graphics) {
  switch (graphics) {
    case Graphics::card:
      return createDeviceContext(DeviceKind::card);
    case Graphics::deviceSoftware:
      return createDeviceContext(DeviceKind::software);
    default:
      return createSoftwareContext();
  }
}

}  // namespace calot::gui
