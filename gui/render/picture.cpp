// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/picture.h"

#include <charconv>

#include "gui/render/view_check.h"
#include "recorder/base/errors.h"

namespace calot::gui {

PictureSize parsePictureSize(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto [afterWidth, widthError] = std::from_chars(text.data(), end, size.width);
  const bool cross = widthError == std::errc() && afterWidth != end && *afterWidth == 'x';
  const auto [afterHeight, heightError] = cross ? std::from_chars(afterWidth + 1, end, size.height)
                                                : std::from_chars_result{end, std::errc::invalid_argument};
  if (!cross || heightError != std::errc() || afterHeight != end)
    throw Error(ErrorKind::invalid, "picture size '" + text + "': write WIDTHxHEIGHT, as in 1280x720");
  checkPictureSize(size.width, size.height);
  return size;
}

}  // namespace calot::gui
