// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/image.h"

#include <fmt/format.h>
#include <png.h>
#include <unistd.h>
#include <charconv>
#include <system_error>

#include "gui/render/view_check.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::gui {

std::string pngBytes(const Image& image) {
  const auto fail = [](const std::string& why) {
    throw Error(ErrorKind::failure, fmt::format("cannot make the picture: {}", why));
  };
  if (image.width <= 0 || image.height <= 0 ||
      image.rgba.size() != 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    fail("the image is empty or its size does not fit its bytes");
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = 0;
  if (png_image_write_get_memory_size(header, size, 0, image.rgba.data(), 0, nullptr) == 0) fail(header.message);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr) == 0)
    fail(header.message);
  bytes.resize(size);
  return bytes;
}

void writePng(const Image& image, const std::string& file) { recorder::writeText(file, pngBytes(image), true); }

std::optional<PictureSize> readSize(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto [cross, widthError] = std::from_chars(text.data(), end, size.width);
  if (widthError != std::errc() || cross == end || *cross != 'x') return std::nullopt;
  const auto [after, heightError] = std::from_chars(cross + 1, end, size.height);
  return heightError == std::errc() && after == end ? std::optional(size) : std::nullopt;
}

PictureSize parsePictureSize(const std::string& text) {
  const std::optional<PictureSize> size = readSize(text);
  if (!size) throw Error(ErrorKind::invalid, "picture size '" + text + "': write WIDTHxHEIGHT, as in 1280x720");
  checkPictureSize(size->width, size->height);
  return *size;
}

}  // namespace calot::gui
