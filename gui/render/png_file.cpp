// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/png_file.h"

#include <fmt/format.h>
#include <png.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "recorder/base/errors.h"

namespace calot::gui {

void writePng(const Image& image, const std::filesystem::path& file) {
  std::filesystem::path temporary = file;
  temporary += fmt::format(".{}.part", ::getpid());
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(ErrorKind::failure, Where{file.string()}, fmt::format("cannot write the picture: {}", why));
  };
  if (image.width <= 0 || image.height <= 0 ||
      image.rgba.size() != 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    fail("the image is empty or its size does not fit its bytes");

  std::FILE* out = std::fopen(temporary.c_str(), "wb");
  if (out == nullptr) fail(std::strerror(errno));
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGBA;
  const bool written = png_image_write_to_stdio(&header, out, 0, image.rgba.data(), 0, nullptr) != 0;
  const std::string why = header.message;
  png_image_free(&header);
  const bool closed = std::fclose(out) == 0;
  if (!written) fail(why);
  if (!closed) fail(std::strerror(errno));
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) fail(error.message());
}

}  // namespace calot::gui
