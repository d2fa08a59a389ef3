// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <string>

#include "recorder/base/errors.h"

namespace calot::apps {

template <class Byte, std::size_t N>
std::string toHex(const std::array<Byte, N>& bytes) {
  std::string text;
  for (const Byte byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(byte));
  return text;
}

/// @throws Error (invalid) naming the option, unless the text is N bytes in hexadecimal.
template <std::size_t N>
std::array<std::byte, N> fromHex(const std::string& text, const char* option) {
  std::array<std::byte, N> bytes{};
  bool good = text.size() == 2 * N;
  for (std::size_t i = 0; good && i < N; ++i) {
    unsigned value = 0;
    const char* begin = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, value, 16);
    good = error == std::errc() && end == begin + 2;
    bytes[i] = static_cast<std::byte>(value);
  }
  if (!good) throw Error(ErrorKind::invalid, fmt::format("{}: {} hexadecimal digits are wanted", option, 2 * N));
  return bytes;
}

}  // namespace calot::apps
